#include "drivers/sensor/pose_noise.hpp"

#include "core/pose.hpp"

namespace vantage::drivers {

models::MeasurementMatrix pose_noise(const models::SensorModel& sensor,
                                     const models::Viewpoint& from,
                                     const models::PositionVector& target_world_m,
                                     const Eigen::Matrix3d& covariance_pose) {
  const models::MeasurementJacobian by_position =
      models::observation_jacobian(sensor, from, target_world_m);
  const Eigen::Vector2d d_m =
      Eigen::Vector2d(target_world_m.head<2>()) - from.world_from_body.position_m();
  // A translation of the body is the opposite translation of the target, and a turn of the body is
  // the opposite turn of the target about the body.
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 3, 3> H(by_position.rows(), 3);
  H.leftCols<2>() = -by_position.leftCols(2);
  H.col(2) = -by_position.leftCols(2) * Eigen::Vector2d(-d_m.y(), d_m.x());
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> added =
      H * covariance_pose * H.transpose();
  return 0.5 * (added + added.transpose());
}

void assume_pose(const models::SensorModel& sensor, int position_dim,
                 const models::PoseEstimate& estimate, models::RobotMeasurement& seen) {
  seen.viewpoint.world_from_body = estimate.world_from_body;
  for (models::Detection& detection : seen.detections) {
    models::Measurement& measurement = detection.measurement;
    auto target_m = models::position_from(sensor, seen.viewpoint, measurement.z, position_dim);
    if (!target_m) {
      models::PositionVector ahead = models::PositionVector::Zero(position_dim);
      ahead.head<2>() = estimate.world_from_body * Eigen::Vector2d(0.5 * sensor.range_max_m, 0.0);
      target_m = ahead;
    }
    measurement.V += pose_noise(sensor, seen.viewpoint, *target_m, estimate.covariance);
  }
}

}  // namespace vantage::drivers
