#include "estimator/posterior/unscented.hpp"

#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>

namespace vantage::estimator {
namespace {

using models::Gaussian;
using models::MeasurementMatrix;
using models::MeasurementVector;
using models::PositionVector;
using models::StateVector;

/// Returns h at the first N components of the state.
MeasurementVector observe_at(const models::SensorModel& sensor, const models::Viewpoint& from,
                             const Eigen::Vector2d& position_m) {
  return models::observe(sensor, from, PositionVector(position_m));
}
MeasurementVector observe_at(const models::SensorModel& sensor, const models::Viewpoint& from,
                             const Eigen::Vector4d& state) {
  return models::observe_state(sensor, from, StateVector(state));
}

/// Updates with points that vary the first N components of the state.
template <int N>
std::optional<Unscented> update_over(const Gaussian& belief, const models::SensorModel& sensor,
                                     const models::Viewpoint& from,
                                     const models::Measurement& measurement) {
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;
  constexpr double kShare = 0.5 / N;
  const Vector mean = belief.mean.template head<N>();
  const Matrix P = belief.covariance.template topLeftCorner<N, N>();
  const Eigen::LLT<Matrix> root(P);
  if (root.info() != Eigen::Success) {
    return std::nullopt;
  }
  const Matrix L = std::sqrt(static_cast<double>(N)) * Matrix(root.matrixL());
  const auto rows = measurement.z.size();
  const MeasurementVector centre = observe_at(sensor, from, mean);
  MeasurementVector deviations[static_cast<std::size_t>(2 * N)];
  MeasurementVector mean_z = MeasurementVector::Zero(rows);
  for (int k = 0; k < 2 * N; ++k) {
    const Vector at = mean + (k < N ? 1.0 : -1.0) * L.col(k % N);
    deviations[k] = models::innovation(sensor, observe_at(sensor, from, at), centre);
    mean_z += kShare * deviations[k];
  }
  MeasurementMatrix S = measurement.V;
  models::MeasurementJacobian Czp = models::MeasurementJacobian::Zero(rows, N);
  for (int k = 0; k < 2 * N; ++k) {
    const Vector away = (k < N ? 1.0 : -1.0) * L.col(k % N);
    const MeasurementVector dz = deviations[k] - mean_z;
    S += kShare * dz * dz.transpose();
    Czp += kShare * dz * away.transpose();
  }
  const Eigen::LLT<MeasurementMatrix> S_root(S);
  if (S_root.info() != Eigen::Success) {
    return std::nullopt;
  }
  const MeasurementVector nu = models::innovation(sensor, measurement.z, centre) - mean_z;
  const double mahalanobis2 = nu.dot(S_root.solve(nu));
  const double root_det = S_root.matrixLLT().diagonal().prod();
  // H of the linear regression: C_zp P⁻¹. The state's gain is Σ Hᵀ S⁻¹.
  const models::MeasurementJacobian H = root.solve(Czp.transpose()).transpose();
  const auto cross = (belief.covariance.template leftCols<N>() * H.transpose()).eval();
  const auto gain = S_root.solve(cross.transpose()).transpose().eval();
  Unscented out{belief, 0.0, std::exp(-0.5 * mahalanobis2), mahalanobis2};
  out.belief.mean += gain * nu;
  out.belief.covariance -= gain * S * gain.transpose();
  out.belief.covariance =
      (0.5 * (out.belief.covariance + out.belief.covariance.transpose())).eval();
  out.likelihood = out.relative_likelihood / root_det;
  return out;
}

}  // namespace

std::optional<Unscented> unscented_update(const Gaussian& belief, const models::SensorModel& sensor,
                                          const models::Viewpoint& from,
                                          const models::Measurement& measurement) {
  return models::measures_velocity(sensor) && belief.mean.size() == 4
             ? update_over<4>(belief, sensor, from, measurement)
             : update_over<2>(belief, sensor, from, measurement);
}

}  // namespace vantage::estimator
