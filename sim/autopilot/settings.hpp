#pragma once

#include <functional>
#include <optional>
#include <string>

#include "scenario/scenario.hpp"

namespace vantage::sim {

/// What the owner of a vehicle has set, as far as an emulated autopilot obeys it. Times that are
/// not there: it never does so.
struct AutopilotSettings {
  // When somebody stops speaking to it.
  double setpoint_loss_s = 0.0;
  bool lands_on_setpoint_loss = false;     ///< otherwise it brakes to a halt and stays in the mode
  std::optional<double> heartbeat_loss_s;  ///< of its ground station's, until it lands
  std::optional<int> station_id;           ///< its ground station's system id; any when absent
  double pose_loss_s = 0.0;                ///< without poses, until its position is lost
  bool lands_on_pose_loss = true;
  bool has_barometer = true;  ///< which keeps its height when poses do not
  // On the ground.
  std::optional<double> idle_disarm_s;  ///< armed and not taken off
  std::optional<double> land_disarm_s;  ///< after a landing was noticed
  // Motion.
  double speed_max_mps = 3.0;
  double land_speed_mps = 0.5;
  double position_gain_per_s = 1.0;
  double yaw_rate_max_radps = 3.5;
  double velocity_gain_per_s = 2.0;
};

/// A parameter's value by its name; nullopt when the vehicle has none.
using ParameterValue = std::function<std::optional<double>(const std::string&)>;

/// With the firmware's own values for those that are not there.
AutopilotSettings settings_of(models::AutopilotDialect dialect, const ParameterValue& value);

}  // namespace vantage::sim
