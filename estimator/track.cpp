#include "estimator/track.hpp"

#include <Eigen/Cholesky>

namespace vantage::estimator {

namespace {

using models::Information;
using models::MeasurementJacobian;
using models::MeasurementMatrix;
using models::MeasurementVector;
using models::StateMatrix;

/// ∂z/∂state from ∂z/∂position: a sensor is blind to everything but position.
MeasurementJacobian state_jacobian(const MeasurementJacobian& by_position, Eigen::Index dim) {
  MeasurementJacobian H = MeasurementJacobian::Zero(by_position.rows(), dim);
  H.leftCols(by_position.cols()) = by_position;
  return H;
}

double growth(double steps) { return 0.5 * steps * (steps + 1.0); }

}  // namespace

std::optional<Information> propagate(const models::TargetModel& model, double step_s,
                                     const Information& information, Time last_seen, Time from,
                                     Time to) {
  // A static belief must not collect the rounding of an inversion that changes nothing.
  if (to == from || model.kind == models::TargetKind::kStatic) {
    return information;
  }
  const double elapsed_s = to_seconds(to - from);
  const StateMatrix A = model.transition(elapsed_s);
  if (model.kind == models::TargetKind::kGrowingUncertainty) {
    const double until = to_seconds(to - last_seen) / step_s;
    const double since = to_seconds(from - last_seen) / step_s;
    const StateMatrix W =
        model.q * (growth(until) - growth(since)) * StateMatrix::Identity(A.rows(), A.cols());
    return models::predict(information, A, W);
  }
  return models::predict(information, A, model.process_noise(elapsed_s));
}

Use measure(Information& belief, const models::SensorModel& sensor, const models::Viewpoint& from,
            const models::Measurement& measurement, double gate_sigma) {
  const Eigen::Index dim = belief.vector.size();
  const Eigen::Index position_dim = dim == 3 ? 3 : 2;
  const Eigen::LLT<StateMatrix> omega(belief.matrix);
  const Eigen::LLT<MeasurementMatrix> noise(measurement.V);
  if (omega.info() != Eigen::Success || noise.info() != Eigen::Success) {
    return Use::kSingular;
  }
  const models::StateVector mean = omega.solve(belief.vector);
  const models::PositionVector position_m = mean.head(position_dim);
  const MeasurementJacobian H =
      state_jacobian(models::observation_jacobian(sensor, from, position_m), dim);
  const MeasurementVector nu =
      models::innovation(sensor, measurement.z, models::observe(sensor, from, position_m));
  if (!H.allFinite() || !nu.allFinite()) {
    return Use::kSingular;
  }
  if (gate_sigma > 0.0) {
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                        models::kMaxTargetDim, models::kMaxMeasurementDim>
        PHt = omega.solve(H.transpose());
    const MeasurementMatrix S = H * PHt + measurement.V;
    const Eigen::LLT<MeasurementMatrix> spread(S);
    const MeasurementVector whitened = spread.matrixL().solve(nu);
    if (whitened.squaredNorm() > gate_sigma * gate_sigma) {
      return Use::kGated;
    }
  }
  const MeasurementJacobian weighted = noise.solve(H);  // V⁻¹ H
  const MeasurementVector z_linear = nu + H * mean;
  belief.matrix += H.transpose() * weighted;
  belief.matrix = (0.5 * (belief.matrix + belief.matrix.transpose())).eval();
  belief.vector += weighted.transpose() * z_linear;
  return Use::kUsed;
}

std::optional<Information> discover(const models::EstimatorSpec& spec,
                                    const models::SensorModel& sensor,
                                    const models::Viewpoint& from,
                                    const models::Measurement& measurement) {
  const int position_dim = spec.target_model.position_dim;
  const auto position_m = models::position_from(sensor, from, measurement.z, position_dim);
  const Eigen::LLT<MeasurementMatrix> noise(measurement.V);
  if (!position_m || noise.info() != Eigen::Success) {
    return std::nullopt;
  }
  const MeasurementJacobian J = models::observation_jacobian(sensor, from, *position_m);
  if (!J.allFinite()) {
    return std::nullopt;
  }
  const Eigen::Index dim = spec.target_model.dim();
  Information belief;
  belief.matrix = StateMatrix::Zero(dim, dim);
  auto position = belief.matrix.topLeftCorner(position_dim, position_dim);
  position = J.transpose() * noise.solve(J);
  if (J.rows() < position_dim) {
    const MeasurementMatrix JJt = J * J.transpose();
    const MeasurementJacobian JJt_inv_J = JJt.llt().solve(J);
    const models::PositionMatrix silent =
        models::PositionMatrix::Identity(position_dim, position_dim) - J.transpose() * JJt_inv_J;
    position += silent / (spec.prior_position_sigma_m * spec.prior_position_sigma_m);
  }
  for (Eigen::Index i = position_dim; i < dim; ++i) {
    belief.matrix(i, i) = 1.0 / (spec.prior_velocity_sigma_mps * spec.prior_velocity_sigma_mps);
  }
  belief.matrix = (0.5 * (belief.matrix + belief.matrix.transpose())).eval();
  models::StateVector mean = models::StateVector::Zero(dim);
  mean.head(position_dim) = *position_m;
  belief.vector = belief.matrix * mean;
  if (Eigen::LLT<StateMatrix>(belief.matrix).info() != Eigen::Success) {
    return std::nullopt;
  }
  return belief;
}

}  // namespace vantage::estimator
