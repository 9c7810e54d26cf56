#pragma once

#include <cstdint>

#include "scenario/scenario.hpp"
#include "sim/autopilot/pose_estimator.hpp"

namespace vantage::sim {

/// How one autopilot behaves, in numbers, whatever its owner has set (settings.hpp); from the
/// recordings of the two real ones in test/data/autopilot.
struct AutopilotProfile {
  std::uint8_t autopilot_id = 0;  ///< in its HEARTBEAT
  std::uint32_t follow_mode = 0;  ///< custom_mode that takes set-points
  std::uint32_t land_mode = 0;
  std::uint32_t start_mode = 0;

  bool speaks_to_stations_alone = false;  ///< texts: where a ground station's heartbeat is heard

  // Estimator, fed with external poses.
  PoseEstimatorTraits estimator;
  double estimator_boot_s = 0.0;     ///< after power-up, until it takes an origin
  double estimator_aligned_s = 0.0;  ///< and until it takes poses
  std::uint16_t flags_ground = 0;
  std::uint16_t flags_air = 0;
  std::uint16_t flags_stale = 0;  ///< in the air, poses of more than 0.6 s ago
  std::uint16_t flags_lost = 0;
  bool needs_origin = false;            ///< before it arms
  double lost_before_failsafe_s = 0.0;  ///< it knows that it is lost, and does nothing yet

  // Arming.
  double accelerometer_delay_s = 0.0;  ///< after boot, until they agree
  double arm_delay_s = 0.0;            ///< after boot, whatever else is ready: gyroscopes, too
  const char* words_of_arming = "";
  const char* words_of_landed = "";  ///< its motors stop after a landing
  const char* words_of_idle = "";    ///< and when it is not taken off
  std::uint8_t refusal = 1;          ///< result of a command that cannot be obeyed now

  // Who speaks to it.
  double setpoint_check_s = 0.0;     ///< it notices so late that set-points have stopped
  double station_check_s = 0.0;      ///< how often it looks whether its station still does
  bool wants_proof_of_life = false;  ///< a stream of set-points before it arms in its mode
  bool takes_off_by_command = false;
  /// Between two targets the place goes on at their velocity.
  bool carries_targets_on = false;
  /// At another kind of target its integrator takes the present acceleration for the wind's.
  bool keeps_braking_on_change = false;

  // Motion.
  double velocity_shaping_s = 0.0;  ///< first-order lag of velocity set-points
  double climb_gain_per_s = 4.0;    ///< PX4: MPC_Z_VEL_P_ACC
  double velocity_integral_per_s2 = 0.15;
  double feed_forward = 0.0;         ///< share of the shaped acceleration
  bool cuts_whole_velocity = false;  ///< at its most; otherwise only what corrects the place
  double climb_max_mps = 0.7;
  double acceleration_max_mps2 = 3.0;
  double yaw_gain_per_s = 2.5;
  double yaw_lag_s = 0.0;         ///< of its rate controller, before the airframe's
  double spool_up_s = 2.0;        ///< motors turn before they lift
  double landed_delay_s = 1.0;    ///< it stands, and does not know yet
  double landing_ahead_s = 0.0;   ///< it lands where its velocity brings it in this time
  double failsafe_pause_s = 0.0;  ///< between a failsafe's landing mode and the descent
};

const AutopilotProfile& profile_of(models::AutopilotDialect dialect);

}  // namespace vantage::sim
