#include "estimator/track.hpp"

#include <cmath>

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

Eigen::Index position_rows(Eigen::Index state_rows) { return state_rows == 3 ? 3 : 2; }

/// A belief wider than this share of its distance is not measured about its mean.
constexpr double kLinearShare = 0.15;
constexpr int kIterations = 3;
/// Nearer than this a direction is rounding.
constexpr double kNearest_m = 1e-6;

/// True when ∂h/∂position does not exist at `about_m`: the target stands where the sensor is.
bool is_at_sensor(const models::SensorModel& sensor, const models::Viewpoint& from,
                  const models::PositionVector& about_m) {
  if (sensor.kind == models::SensorKind::kPosition || sensor.kind == models::SensorKind::kCamera) {
    return false;
  }
  const double level_m = (about_m.head<2>() - from.world_from_body.position_m()).norm();
  const bool ranges_in_space = sensor.kind == models::SensorKind::kRange && about_m.size() == 3;
  const double apart_m =
      ranges_in_space ? std::hypot(level_m, about_m(2) - from.height_m) : level_m;
  return apart_m < kNearest_m;
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

models::PositionVector linearisation_point(const models::Gaussian& belief,
                                           const models::SensorModel& sensor,
                                           const models::Viewpoint& from,
                                           const models::Measurement& measurement) {
  const Eigen::Index n = position_rows(belief.mean.size());
  models::PositionVector about_m = belief.mean.head(n);
  if (sensor.kind == models::SensorKind::kPosition) {
    return about_m;  // linear everywhere
  }
  const double variance_m2 = belief.covariance.topLeftCorner(n, n).trace();
  const double distance_m = (about_m.head<2>() - from.world_from_body.position_m()).norm();
  if (variance_m2 <= kLinearShare * kLinearShare * distance_m * distance_m) {
    return about_m;
  }
  const auto seen_m = models::position_from(sensor, from, measurement.z, static_cast<int>(n));
  if (!seen_m) {
    return about_m;
  }
  about_m = *seen_m;
  for (int i = 0; i < kIterations; ++i) {
    const MeasurementJacobian H =
        state_jacobian(models::observation_jacobian(sensor, from, about_m), belief.mean.size());
    models::StateVector offset = belief.mean;
    offset.head(n) -= about_m;
    const MeasurementVector expected = models::observe(sensor, from, about_m);
    MeasurementVector nu = models::innovation(sensor, measurement.z, expected);
    nu -= H.leftCols(n) * offset.head(n);
    const models::Gaussian posterior = models::update(belief, H, measurement.V, nu);
    const models::PositionVector next_m = posterior.mean.head(n);
    if (!next_m.allFinite()) {
      break;
    }
    about_m = next_m;
  }
  return about_m;
}

Use measure(Information& belief, const models::SensorModel& sensor, const models::Viewpoint& from,
            const models::Measurement& measurement, double gate_sigma) {
  const Eigen::Index n = position_rows(belief.vector.size());
  const std::optional<models::Gaussian> prior = models::to_gaussian(belief);
  const Eigen::LLT<MeasurementMatrix> noise(measurement.V);
  if (!prior || noise.info() != Eigen::Success) {
    return Use::kSingular;
  }
  const models::PositionVector about_m = linearisation_point(*prior, sensor, from, measurement);
  if (is_at_sensor(sensor, from, about_m)) {
    return Use::kSingular;
  }
  const MeasurementJacobian H =
      state_jacobian(models::observation_jacobian(sensor, from, about_m), belief.vector.size());
  const MeasurementVector expected = models::observe(sensor, from, about_m);
  // z − h(x, a) + H a: what a linear sensor H would have measured of the whole state.
  const MeasurementVector z_linear =
      models::innovation(sensor, measurement.z, expected) + H.leftCols(n) * about_m;
  if (!H.allFinite() || !z_linear.allFinite()) {
    return Use::kSingular;
  }
  if (gate_sigma > 0.0) {
    const MeasurementVector nu = z_linear - H * prior->mean;
    const MeasurementJacobian HP = H * prior->covariance;
    const MeasurementMatrix S = HP * H.transpose() + measurement.V;
    const MeasurementVector whitened = S.llt().matrixL().solve(nu);
    if (whitened.squaredNorm() > gate_sigma * gate_sigma) {
      return Use::kGated;
    }
  }
  const MeasurementJacobian weighted = noise.solve(H);  // V⁻¹ H
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
