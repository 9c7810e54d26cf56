#pragma once

#include <optional>

#include <Eigen/Core>

#include "models/sensor/sensor.hpp"

namespace vantage::drivers {

/// Returns the measurement of a target whose position a detector has measured: z = h(position) with
/// the covariance H Σ Hᵀ. If the covariance Σ is zero, the sensor's covariance is used instead.
/// Nullopt if the sensor cannot have measured the target from `viewpoint`.
/// @param position_dim  2: only x and y are used
std::optional<models::Measurement> measurement_at(const models::SensorModel& sensor,
                                                  const models::Viewpoint& viewpoint,
                                                  const Eigen::Vector3d& position_world_m,
                                                  const Eigen::Matrix3d& covariance_world_m2,
                                                  int position_dim);

}  // namespace vantage::drivers
