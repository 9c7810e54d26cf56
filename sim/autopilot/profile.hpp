#pragma once

#include <cstdint>

#include "models/scenario/scenario.hpp"

namespace vantage::sim {

/// How one autopilot behaves, in numbers; from flights of the two real ones in their own
/// simulators, with external poses as the only position source.
struct AutopilotProfile {
  std::uint8_t autopilot_id = 0;  ///< in its HEARTBEAT
  std::uint32_t follow_mode = 0;  ///< custom_mode that takes set-points
  std::uint32_t land_mode = 0;
  std::uint32_t start_mode = 0;

  bool speaks_to_stations_alone = false;  ///< texts: where a ground station's heartbeat is heard

  // Estimator, fed with external poses.
  double converge_s = 3.5;   ///< of poses, until it is ready
  double pose_loss_s = 5.0;  ///< without poses, until it says that it is lost
  std::uint16_t flags_ground = 0;
  std::uint16_t flags_air = 0;
  std::uint16_t flags_lost = 0;
  bool needs_origin = false;

  // Arming.
  double arm_delay_s = 0.0;     ///< after boot, whatever else is ready
  std::uint8_t refusal = 1;     ///< result of a command that cannot be obeyed now
  double idle_disarm_s = 10.0;  ///< armed and not taken off

  // Set-points.
  bool wants_proof_of_life = false;  ///< a stream of them before its mode is entered
  double setpoint_loss_s = 1.0;
  bool lands_on_setpoint_loss = false;  ///< otherwise it brakes to a halt and stays in the mode
  bool takes_off_by_command = false;
  /// Between two targets the place goes on at their velocity.
  bool carries_targets_on = false;
  /// At another kind of target its integrator takes the present acceleration for the wind's.
  bool keeps_braking_on_change = false;

  // Motion.
  double velocity_shaping_s = 0.0;   ///< first-order lag of velocity set-points
  double velocity_gain_per_s = 1.8;  ///< PX4: MPC_XY_VEL_P_ACC
  double climb_gain_per_s = 4.0;     ///< PX4: MPC_Z_VEL_P_ACC
  double velocity_integral_per_s2 = 0.15;
  double feed_forward = 0.0;  ///< share of the shaped acceleration
  double position_gain_per_s = 0.95;
  double speed_max_mps = 3.0;
  double climb_max_mps = 0.7;
  double acceleration_max_mps2 = 3.0;
  double spool_up_s = 2.0;  ///< motors turn before they lift
  double land_speed_mps = 0.4;
  double land_disarm_s = 3.0;  ///< after touch-down
};

const AutopilotProfile& profile_of(models::AutopilotDialect dialect);

}  // namespace vantage::sim
