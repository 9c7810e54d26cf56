#pragma once

#include <functional>
#include <optional>
#include <string>

#include "scenario/scenario.hpp"

namespace vantage::sim {

/// Settings that the user of an emulated autopilot can change. An absent time means that the
/// autopilot never performs the action.
struct AutopilotSettings {
  // Loss of set-points, heartbeats and poses.
  double setpoint_loss_s = 0.0;
  bool lands_on_setpoint_loss = false;  ///< false: brakes to a stop and stays in the mode
  /// s; time without a heartbeat of the ground station until the vehicle lands
  std::optional<double> heartbeat_loss_s;
  std::optional<int> station_id;  ///< system id of the ground station; absent: any station
  double pose_loss_s = 0.0;       ///< s; time without poses until the position is lost
  bool lands_on_pose_loss = true;
  bool has_barometer = true;  ///< the height estimate remains valid without poses
  // Times on the ground.
  std::optional<double> idle_disarm_s;  ///< s; time from arming without take-off until disarming
  std::optional<double> land_disarm_s;  ///< s; time from the detected landing to disarming
  // Parameters of motion.
  double speed_max_mps = 3.0;
  double land_speed_mps = 0.5;
  double position_gain_per_s = 1.0;
  double yaw_rate_max_radps = 3.5;
  double velocity_gain_per_s = 2.0;
};

/// Function that returns a parameter's value by name; nullopt if the vehicle has no such parameter.
using ParameterValue = std::function<std::optional<double>(const std::string&)>;

/// Returns the settings for these parameters, with the firmware's defaults for absent ones.
AutopilotSettings settings_of(models::AutopilotDialect dialect, const ParameterValue& value);

}  // namespace vantage::sim
