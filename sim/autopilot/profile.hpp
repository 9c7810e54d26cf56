#pragma once

#include <cstdint>

#include "scenario/scenario.hpp"
#include "sim/autopilot/pose_estimator.hpp"

namespace vantage::sim {

/// Behaviour of one autopilot that the user cannot set (see settings.hpp for settings). The numbers
/// are from recordings of the two real autopilots in test/data/autopilot.
struct AutopilotProfile {
  std::uint8_t autopilot_id = 0;  ///< field `autopilot` of its HEARTBEAT
  std::uint32_t follow_mode = 0;  ///< custom_mode in which set-points are accepted
  std::uint32_t land_mode = 0;
  std::uint32_t start_mode = 0;

  bool texts_need_station = false;  ///< true: texts are sent only if a ground station is present

  // Parameters of the estimator, which fuses external poses.
  PoseEstimatorTraits estimator;
  double estimator_boot_s = 0.0;     ///< s; from power-up until the estimator accepts an origin
  double estimator_aligned_s = 0.0;  ///< s; from power-up until the estimator fuses poses
  std::uint16_t flags_ground = 0;
  std::uint16_t flags_air = 0;
  /// estimator's status flags in the air if the newest pose is older than 0.6 s
  std::uint16_t flags_stale = 0;
  std::uint16_t flags_lost = 0;
  bool needs_origin = false;            ///< an origin is required for arming
  double lost_before_failsafe_s = 0.0;  ///< s; from the loss of position to the failsafe

  // Parameters of arming.
  double accelerometer_delay_s = 0.0;  ///< s; from boot until the accelerometers agree
  double arm_delay_s = 0.0;            ///< s; from boot until the gyroscopes agree
  const char* arming_text = "";
  const char* landed_text = "";  ///< text when the motors stop after a landing
  const char* idle_text = "";    ///< text when the motors stop because no take-off followed
  std::uint8_t refusal = 1;      ///< result code of a command that is refused in the present state

  // Loss of set-points and of the ground station.
  double setpoint_check_s = 0.0;     ///< s; delay of the detection that set-points have stopped
  double station_check_s = 0.0;      ///< s; period of the check of the ground station's heartbeat
  bool wants_proof_of_life = false;  ///< set-points are required to enter follow_mode or arm in it
  bool takes_off_by_command = false;
  /// Between two set-points, extrapolates the position at the velocity of the last set-point.
  bool extrapolates_targets = false;
  /// When the kind of set-point changes, the integrator is set to the present acceleration, as if
  /// the wind caused that acceleration.
  bool keeps_braking_on_change = false;

  // Parameters of motion.
  double velocity_shaping_s = 0.0;  ///< s; first-order lag of velocity set-points
  double climb_gain_per_s = 4.0;    ///< 1/s; PX4 parameter MPC_Z_VEL_P_ACC
  double velocity_integral_per_s2 = 0.15;
  double feed_forward = 0.0;         ///< factor of the shaped acceleration, 0 to 1
  bool cuts_whole_velocity = false;  ///< the speed setting limits the total velocity
  double climb_max_mps = 0.7;
  double acceleration_max_mps2 = 3.0;
  double yaw_gain_per_s = 2.5;
  double yaw_lag_s = 0.0;         ///< s; lag of the yaw rate controller
  double spool_up_s = 2.0;        ///< s; time that the motors turn before the vehicle lifts off
  double landed_delay_s = 1.0;    ///< s; from touch-down to its detection
  double landing_ahead_s = 0.0;   ///< s; the landing point is extrapolated by this time
  double failsafe_pause_s = 0.0;  ///< s; from a failsafe's change to landing mode to the descent
};

const AutopilotProfile& profile_of(models::AutopilotDialect dialect);

}  // namespace vantage::sim
