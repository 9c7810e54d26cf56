#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// All thresholds of flight safety. The defaults are for a lab with mocap at 100 Hz and a vehicle
/// of about 1 kg; limits_for() replaces those that the scenario determines. The row of conditions()
/// that names a limit states its effect.
struct SafetyLimits {
  // Limits of the pose; ages count from the arrival at the receiver.
  double pose_age_warn_s = 0.05;
  double pose_age_hold_s = 0.10;
  double pose_age_land_s = 0.50;
  double pose_age_kill_s = 1.50;
  double safe_height_m = 0.15;   ///< m; below this height the motors may stop without damage
  double touch_height_m = 0.06;  ///< m; a landing is complete below this height
  double pose_latency_hold_s = 0.10;
  int pose_rejected_hold = 3;   ///< number of consecutive implausible poses
  int pose_frames_to_arm = 50;  ///< number of consecutive plausible poses
  double pose_gate_m = 0.25;    ///< m; largest distance from the prediction after a short gap
  /// m; largest such distance after any gap; < separation_hold_m / 2
  double pose_gate_max_m = 0.26;
  double pose_flip_rad = 1.0;  ///< rad; larger than any turn of a vehicle between two poses
  double pose_stuck_moving_s = 0.05;
  double pose_stuck_hover_s = 0.5;
  /// m; poses farther outside the volume are rejected, unless they continue a track in the air
  double volume_margin_m = 1.0;

  // Pose without motion capture (POSE_R).
  bool moves_by_estimate = false;   ///< false: such poses are not used
  double pose_sigma_hold_m = 0.15;  ///< m; 1σ of the position
  double pose_sigma_land_m = 0.4;   ///< m; 1σ of the position
  double pose_sigma_margin = 3.0;   ///< distances are reduced by this multiple of 1σ

  // Limits of plans.
  double round_s = 0.0;  ///< s; time after which the next plan replaces a plan; 0: unknown
  /// s; age of the last accepted plan once that plan has ended; longer than one round
  double plan_age_hold_s = 2.0;
  double plan_silent_warn_s = 2.0;
  int plans_late_hold = 3;
  double plan_past_max_s = 0.5;    ///< s; maximum time from the start of a plan to its arrival
  double plan_future_max_s = 5.0;  ///< s; maximum time from the arrival of a plan to its start
  double plan_start_tolerance_m = 0.4;
  double plan_start_turn_rad = 0.8;
  /// s; time without a message of another version that is required for arming
  double other_version_clear_s = 5.0;
  double planner_lease_s = 2.0;
  double tracking_hold_m = 0.4;  ///< m; 3D tracking error
  double tracking_land_m = 1.0;

  // Limits of the position and the stopping position of the vehicle.
  models::World fence;  ///< bounds, ceiling, obstacles
  double fence_land_m = 0.0;
  double fence_kill_m = 1.0;  ///< m; distance of the centre beyond the bounds or the ceiling
  /// s; time of flight before braking begins: age of the pose and of the set-point, plus the
  /// autopilot's lag.
  double reaction_s = 0.20;
  /// s; additional time of flight when set-points stop: the longest autopilot timeout that
  /// config/autopilot permits for arming, plus an allowance for gentler braking. Used by
  /// stopping_distance_after_loss_m().
  double setpoint_loss_s = 0.30;
  double separation_hold_m = 0.55;
  double separation_land_m = 0.5;
  double plan_separation_m = 0.6;
  double speed_hold_ratio = 1.3;       ///< ratio of speed to the vehicle's maximum speed
  double other_pose_growth_mps = 0.5;  ///< m/s; growth of the uncertainty radius of an unseen body
  double other_pose_growth_max_m = 0.5;
  /// m/s²; horizontal acceleration with which a body other than a robot may leave its straight
  /// path. A person walking at 1.5 m/s can turn by 90° within 0.8 s, or start to walk.
  double other_turn_mps2 = 3.0;
  /// s; prediction time of a body other than a robot in the plan check
  double other_prediction_s = 3.0;
  /// s; prediction time of bodies near a landing spot, at most until touchdown
  double landing_prediction_s = 1.5;
  double descent_prediction_s = 0.5;  ///< s; prediction time of bodies below a descending vehicle
  /// m; a vehicle that hovers closer to fence or obstacles moves away
  double hover_clearance_m = 0.1;
  double landing_clearance_m = 0.7;  ///< m; horizontal clearance from bodies below

  // Limits and timing of the vehicle.
  models::VehicleLimits vehicle;
  double lateral_max_mps2 = 10.0;
  double take_off_height_m = 1.0;
  double setpoint_lead_s = 0.1;      ///< s; set-points give the state this far in the future
  double acceleration_lead_s = 0.1;  ///< s; lead of the acceleration in a set-point
  double climb_mps = 0.5;
  double descent_mps = 0.6;
  /// m/s; descent speed below low_height_m, slow enough to stop above a person who steps below
  double low_descent_mps = 0.4;
  double low_height_m = 1.0;

  // Checks that the commanded vehicle is the body that mocap shows: on the ground and in the first
  // lift.
  double body_tilt_arm_rad = 0.26;  ///< rad; largest tilt by mocap for arming
  /// rad; largest difference of the vertical between mocap and the autopilot
  double attitude_error_arm_rad = 0.17;
  double yaw_error_arm_rad = 0.26;  ///< rad; largest yaw difference between mocap and the autopilot
  std::optional<Pose2> start;  ///< start pose in the scenario; the first flight must begin near it
  /// m; largest distance from `start` at take-off of the first flight
  double start_off_arm_m = 0.5;
  double start_turn_arm_rad = 0.3;
  double lift_height_m = 0.2;  ///< m above the ground position; hover height of the first lift
  double lift_done_m = 0.3;    ///< m; rise of this vehicle after which the next one may lift
  double lift_risen_m = 0.1;
  /// s; maximum time from the take-off order to lift_risen_m, including motor start
  double lift_wait_s = 6.0;
  /// s; longest motor idling while another vehicle lifts; autopilots stop idle motors after 10 s
  double lift_idle_s = 5.0;
  double lift_proof_s = 8.0;  ///< s; maximum hover in the first lift until step and turn are seen
  double lift_step_m = 0.15;  ///< m; size of the step along each horizontal axis
  double lift_turn_rad = 0.2;
  /// m; horizontal distance from the segment between the start and the step goal
  double lift_deviation_m = 0.3;
  double lift_other_rise_m = 0.06;     ///< m; rise of another body, or uncommanded rise of this one
  double lift_climb_error_mps = 0.35;  ///< m/s; climb rate error between mocap and autopilot
  double lift_turn_error_radps = 0.8;  ///< rad/s; yaw rate error between mocap and gyroscopes
  double arm_wait_s = 10.0;            ///< s; a command that is forbidden for longer is dropped
  double take_off_prediction_s = 1.0;  ///< s; prediction time of bodies that approach a take-off

  double battery_arm_share = 0.30;
  double battery_low_share = 0.25;
  double battery_land_share = 0.15;
  double battery_empty_share = 0.05;
  double battery_age_land_s = 10.0;
  double battery_stuck_land_s = 60.0;
  double flight_max_s = 900.0;
  double heartbeat_age_hold_s = 1.5;  ///< s; autopilots send a heartbeat at 1 Hz
  double heartbeat_age_land_s = 3.0;
  double telemetry_age_hold_s = 0.5;
  double estimate_error_hold_m = 0.3;
  double estimate_error_land_m = 1.0;
  /// m/s; difference of the horizontal velocities by mocap and by the autopilot, averaged over
  /// velocity_memory_s.
  double velocity_error_hold_mps = 0.3;
  double velocity_error_land_mps = 0.45;
  double velocity_memory_s = 1.0;
  /// m/s; a vehicle that is faster by mocap or by the autopilot does not hover
  double hover_speed_mps = 0.25;
  double hover_off_m = 0.2;    ///< m; horizontal distance from the commanded hover position
  double sink_error_m = 0.35;  ///< m above the commanded height during the descent
  double tilt_kill_rad = 1.05;

  // Limits of the operator and of this process.
  bool needs_operator = true;
  double operator_age_hold_s = 1.0;
  double operator_age_land_s = 3.0;
  double stall_hold_s = 0.25;  ///< s; maximum time between two ticks of this driver
  /// s; time per second that this thread waited for a processor. stall_hold_s and the age of poses
  /// detect single long waits; this sum detects a permanently busy host. It is 0.03 to 0.05 s on a
  /// host with free processors.
  double processor_wait_hold_s = 0.30;
  double processor_wait_arm_s = 0.15;  ///< s; limit of the waiting time per second for arming
  double clear_s = 0.5;  ///< s; a condition that clears by itself must have ended this long ago
  double yield_s = 2.0;  ///< s; additional time for the vehicle that must yield
};

/// Returns the distance from the stop command at `speed_mps` to standstill, m: v T + v²/2a with T =
/// reaction_s.
double stopping_distance_m(const SafetyLimits& limits, double speed_mps);
/// Returns the distance to standstill after the driver or its link has failed, m: T includes
/// setpoint_loss_s.
double stopping_distance_after_loss_m(const SafetyLimits& limits, double speed_mps);
/// Returns half the time between standstill and maximum speed, s. Course begins a change of speed
/// this long before the plan does.
double half_window_s(const models::VehicleLimits& vehicle);

/// Returns the defaults with the scenario's world, separation, tracking tolerance and round, the
/// robot's limits, and the reaction time of its autopilot.
/// @throws UsageError for an unknown robot, or if check_limits() fails.
SafetyLimits limits_for(const scenario::Scenario& scenario, const std::string& robot);

/// Checks the order of thresholds of different severity, and that other limits are finite and
/// positive.
/// @throws UsageError with the name and the rule of the first limit that fails.
void check_limits(const SafetyLimits& limits);

}  // namespace vantage::drivers
