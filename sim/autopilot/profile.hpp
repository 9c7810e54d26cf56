#pragma once

#include <cstdint>

#include "scenario/scenario.hpp"
#include "sim/autopilot/pose_estimator.hpp"

namespace vantage::sim {

/// Behaviour of one autopilot as numbers that its owner cannot set (see settings.hpp). They come
/// from the recordings of the two real autopilots in test/data/autopilot.
struct AutopilotProfile {
  std::uint8_t autopilot_id = 0;  ///< in its HEARTBEAT
  std::uint32_t follow_mode = 0;  ///< custom_mode that follows set-points
  std::uint32_t land_mode = 0;
  std::uint32_t start_mode = 0;

  bool texts_need_station = false;  ///< sends texts only with a ground station present

  // Estimator, fed with external poses.
  PoseEstimatorTraits estimator;
  double estimator_boot_s = 0.0;     ///< after power-up, until it accepts an origin
  double estimator_aligned_s = 0.0;  ///< after power-up, until it fuses poses
  std::uint16_t flags_ground = 0;
  std::uint16_t flags_air = 0;
  std::uint16_t flags_stale = 0;  ///< in the air, newest pose older than 0.6 s
  std::uint16_t flags_lost = 0;
  bool needs_origin = false;            ///< to arm
  double lost_before_failsafe_s = 0.0;  ///< from the loss of position to the failsafe

  // Arming.
  double accelerometer_delay_s = 0.0;  ///< after boot, until the accelerometers agree
  double arm_delay_s = 0.0;            ///< after boot; minimum time until it arms (gyroscopes)
  const char* arming_text = "";
  const char* landed_text = "";  ///< text when the motors stop after a landing
  const char* idle_text = "";    ///< text when the motors stop because it did not take off
  std::uint8_t refusal = 1;      ///< result code of a command that is refused now

  // Loss of set-points and of the ground station.
  double setpoint_check_s = 0.0;     ///< delay of its detection that set-points have stopped
  double station_check_s = 0.0;      ///< period of its check of the ground station's heartbeat
  bool wants_proof_of_life = false;  ///< needs set-points to arm in follow_mode or to enter it
  bool takes_off_by_command = false;
  /// Between two targets, extrapolates the target position at the target velocity.
  bool carries_targets_on = false;
  /// When the kind of target changes, the integrator takes over the present acceleration as if the
  /// wind caused it.
  bool keeps_braking_on_change = false;

  // Motion.
  double velocity_shaping_s = 0.0;  ///< first-order lag of velocity set-points
  double climb_gain_per_s = 4.0;    ///< PX4: MPC_Z_VEL_P_ACC
  double velocity_integral_per_s2 = 0.15;
  double feed_forward = 0.0;         ///< share of the shaped acceleration, 0 to 1
  bool cuts_whole_velocity = false;  ///< limits the whole velocity, not only the correction
  double climb_max_mps = 0.7;
  double acceleration_max_mps2 = 3.0;
  double yaw_gain_per_s = 2.5;
  double yaw_lag_s = 0.0;         ///< lag of its rate controller, before that of the airframe
  double spool_up_s = 2.0;        ///< motors turn for this time before they lift
  double landed_delay_s = 1.0;    ///< from touch-down to its detection
  double landing_ahead_s = 0.0;   ///< landing point: position extrapolated by this time
  double failsafe_pause_s = 0.0;  ///< from a failsafe's change to landing mode to the descent
};

const AutopilotProfile& profile_of(models::AutopilotDialect dialect);

}  // namespace vantage::sim
