#pragma once

#include <Eigen/Core>

namespace vantage::drivers {

/// Commanded state of a vehicle at one instant. Set-points are always sent with all fields: if the
/// set of fields changes, ArduPilot restarts its position controller and keeps the present
/// deceleration (docs/decisions/0009).
struct Setpoint {
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_world_mps2 = Eigen::Vector3d::Zero();  ///< only set by Course
  double yaw_rad = 0.0;
  double yaw_rate_radps = 0.0;
};

}  // namespace vantage::drivers
