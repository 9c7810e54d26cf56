#pragma once

#include <Eigen/Core>

#include "models/exchange/messages.hpp"
#include "models/exchange/pose_messages.hpp"
#include "models/sensor/sensor.hpp"

namespace vantage::drivers {

/// Returns the covariance H P Hᵀ that an error of the sensor's pose (x, y, yaw) with the covariance
/// P adds to a measurement of a target at `target_world_m`. H = ∂h/∂pose follows from ∂h/∂position:
/// only the target's position in the body frame matters.
models::MeasurementMatrix pose_noise(const models::SensorModel& sensor,
                                     const models::Viewpoint& from,
                                     const models::PositionVector& target_world_m,
                                     const Eigen::Matrix3d& covariance_pose);

/// Replaces the viewpoint of `seen` by the estimated pose (the height remains), and adds
/// pose_noise() to the covariance of each measurement. A measurement that does not determine a
/// position is assumed to be of a target in the middle of the sensor's range, straight ahead.
///
/// The errors of all measurements with the same pose are correlated. An estimator that uses only
/// the covariance of each measurement ignores this correlation (docs/guide/localisation.md).
void assume_pose(const models::SensorModel& sensor, int position_dim,
                 const models::PoseEstimate& estimate, models::RobotMeasurement& seen);

}  // namespace vantage::drivers
