#include "drivers/sensor/detected_position.hpp"

namespace vantage::drivers {
namespace {

/// Smallest variance of a measurement, relative to the variance of the robot's sensor. This limit
/// keeps the covariance positive definite.
constexpr double kVarianceShareMin = 1e-6;

}  // namespace

std::optional<models::Measurement> measurement_at(const models::SensorModel& sensor,
                                                  const models::Viewpoint& viewpoint,
                                                  const Eigen::Vector3d& position_world_m,
                                                  const Eigen::Matrix3d& covariance_world_m2,
                                                  int position_dim) {
  const models::PositionVector position_m = position_world_m.head(position_dim);
  if (!models::in_view(sensor, viewpoint, position_m)) {
    return std::nullopt;
  }
  models::Measurement out;
  out.z = models::observe(sensor, viewpoint, position_m);
  out.V = models::noise_covariance(sensor, viewpoint, position_m);
  if (!covariance_world_m2.isZero(0.0)) {
    const models::MeasurementJacobian jacobian =
        models::observation_jacobian(sensor, viewpoint, position_m);
    out.V = kVarianceShareMin * out.V +
            jacobian * covariance_world_m2.topLeftCorner(position_dim, position_dim) *
                jacobian.transpose();
  }
  return out;
}

}  // namespace vantage::drivers
