#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Every number that flight safety compares with. The defaults are for a lab with mocap at 100 Hz
/// and a vehicle of about 1 kg; limits_for() takes from the scenario what the scenario says.
/// What each one does is said by the row of conditions() that names it.
struct SafetyLimits {
  // The pose, by the receiver's own arrival times.
  double pose_age_warn_s = 0.05;
  double pose_age_hold_s = 0.10;
  double pose_age_land_s = 0.50;
  double pose_age_kill_s = 1.50;
  double safe_height_m = 0.15;   ///< below it motors may stop without harm
  double touch_height_m = 0.06;  ///< below it a landing has landed
  double pose_latency_hold_s = 0.10;
  int pose_rejected_hold = 3;     ///< implausible poses in a row
  int pose_frames_to_arm = 50;    ///< plausible ones in a row
  double pose_gate_m = 0.25;      ///< around the prediction, at the next frame
  double pose_gate_max_m = 0.26;  ///< however long the gap; less than half of separation_hold_m
  double pose_flip_rad = 1.0;     ///< turn between two poses that no vehicle makes
  double pose_stuck_moving_s = 0.05;
  double pose_stuck_hover_s = 0.5;
  double volume_margin_m = 1.0;  ///< poses farther outside the bounds are not believed

  // The plan.
  double round_s = 0.0;  ///< after it the next plan takes over, if there is one; 0: not known
  double plan_age_hold_s = 2.0;  ///< once it has ended; longer than a round
  double plan_silent_warn_s = 2.0;
  int plans_late_hold = 3;
  double plan_past_max_s = 0.5;    ///< start before the arrival
  double plan_future_max_s = 5.0;  ///< start after the arrival
  double plan_start_tolerance_m = 0.4;
  double plan_start_turn_rad = 0.8;
  double other_version_clear_s = 5.0;  ///< nobody spoke another version for so long, to arm
  double planner_lease_s = 2.0;
  double tracking_hold_m = 0.4;  ///< in all three directions
  double tracking_land_m = 1.0;

  // Where the vehicle is and will stop.
  models::World fence;  ///< bounds, ceiling, obstacles
  double fence_land_m = 0.0;
  double fence_kill_m = 1.0;  ///< of the centre, outside the bounds or above the ceiling
  /// Flown on before braking bites: age of the pose and of the set-point, and the autopilot's lag.
  double reaction_s = 0.20;
  /// Flown on when set-points stop: the autopilot's own time-out, the longest that config/autopilot
  /// lets arm, and how gently it stops then. See lost_way_m().
  double setpoint_loss_s = 0.30;
  double separation_hold_m = 0.55;
  double separation_land_m = 0.5;
  double plan_separation_m = 0.6;
  double speed_hold_ratio = 1.3;       ///< of the vehicle's greatest speed
  double other_pose_growth_mps = 0.5;  ///< how fast an unseen body's tube widens
  double other_pose_growth_max_m = 0.5;
  /// Acceleration in the plane by which a body other than a robot may leave its straight path: a
  /// person who walks at 1.5 m/s turns by 90° within 0.8 s, or stands and begins to walk.
  double other_turn_mps2 = 3.0;
  double other_goes_on_s = 3.0;      ///< such a body is carried on straight in the plan check
  double landing_look_s = 1.5;       ///< and where a landing goes to, or until the vehicle is down
  double sinking_look_s = 0.5;       ///< and below a vehicle that comes down
  double hover_clearance_m = 0.1;    ///< from the fence and obstacles, or it moves off
  double landing_clearance_m = 0.7;  ///< from bodies below

  // The vehicle.
  models::VehicleLimits vehicle;
  double lateral_max_mps2 = 10.0;
  double take_off_height_m = 1.0;
  double setpoint_lead_s = 0.1;      ///< what is asked now is what is to be so much later
  double acceleration_lead_s = 0.1;  ///< the same of the acceleration
  double climb_mps = 0.5;
  double descent_mps = 0.6;
  double low_descent_mps = 0.4;  ///< below low_height_m: it must stop above who walks in there
  double low_height_m = 1.0;

  // The vehicle commanded is the body seen: on the ground, and by a first small lift.
  double body_tilt_arm_rad = 0.26;       ///< that mocap shows
  double attitude_error_arm_rad = 0.17;  ///< of level, between mocap and the autopilot
  double yaw_error_arm_rad = 0.26;       ///< the same of yaw
  std::optional<Pose2> start;            ///< world from body, where its first flight begins
  double start_off_arm_m = 0.5;          ///< from there, before its first flight
  double start_turn_arm_rad = 0.3;
  double lift_height_m = 0.2;  ///< above where it stood, until it is proven
  double lift_over_m = 0.3;    ///< beyond it the next one may lift
  double lift_risen_m = 0.1;
  double lift_wait_s = 6.0;   ///< from `take-off`, motors spooling up included, to lift_risen_m
  double lift_idle_s = 5.0;   ///< motors idle so long for their turn; autopilots stop them after 10
  double lift_proof_s = 8.0;  ///< at lift_height_m, until a step and a turn are seen
  double lift_step_m = 0.15;  ///< to the side, along each axis
  double lift_turn_rad = 0.2;
  double lift_astray_m = 0.3;          ///< seen from above, from where it is told to be
  double lift_other_m = 0.06;          ///< that another body rises instead
  double lift_climb_error_mps = 0.35;  ///< between the body and the autopilot's own estimate
  double lift_turn_error_radps = 0.8;  ///< between the body and the autopilot's gyroscopes
  double arm_wait_s = 10.0;            ///< an order that cannot be obeyed is forgotten
  double take_off_look_s = 1.0;        ///< ahead, for who comes near a take-off

  double battery_arm_share = 0.30;
  double battery_low_share = 0.25;
  double battery_land_share = 0.15;
  double battery_empty_share = 0.05;
  double battery_age_land_s = 10.0;
  double battery_stuck_land_s = 60.0;
  double flight_max_s = 900.0;
  double heartbeat_age_hold_s = 1.5;  ///< autopilots send at 1 Hz
  double heartbeat_age_land_s = 3.0;
  double telemetry_age_hold_s = 0.5;
  double estimate_error_hold_m = 0.3;
  double estimate_error_land_m = 1.0;
  /// Difference of the velocities by mocap and by the autopilot in the plane, averaged over
  /// velocity_memory_s.
  double velocity_error_hold_mps = 0.3;
  double velocity_error_land_mps = 0.45;
  double velocity_memory_s = 1.0;
  double hover_speed_mps = 0.25;  ///< of one that hovers, by mocap and by the autopilot
  double hover_off_m = 0.2;       ///< from where it is to hover, seen from above
  double sink_error_m = 0.35;     ///< above the commanded height while it comes down
  double tilt_kill_rad = 1.05;

  // The operator and this process.
  bool needs_operator = true;
  double operator_age_hold_s = 1.0;
  double operator_age_land_s = 3.0;
  double stall_hold_s = 0.25;  ///< between two of our own ticks
  /// Sum of the times that our own thread waited for a processor within a second. Single long waits
  /// are seen by stall_hold_s and by the age of poses; this sees a host that is busy throughout. On
  /// a host with free processors the sum is 0.03 to 0.05 s.
  double processor_wait_hold_s = 0.30;
  double processor_wait_arm_s = 0.15;  ///< the same, of a vehicle that is to be armed
  double clear_s = 0.5;  ///< a condition must be gone this long before it clears itself
  double yield_s = 2.0;  ///< more, for the vehicle that must let the other go first
};

/// From where a vehicle is told to stop at `speed_mps` to where it stands: v T + v²/2a.
double stopping_way_m(const SafetyLimits& limits, double speed_mps);
/// The same when nobody tells it any more: its driver or its link has died.
double lost_way_m(const SafetyLimits& limits, double speed_mps);
/// Half the time in which a vehicle comes from rest to its greatest speed, or back: by so much it
/// begins before its plan changes (see Course).
double half_window_s(const models::VehicleLimits& vehicle);

/// Defaults with the scenario's world, separation, tracking tolerance and the robot's own limits,
/// and the reaction of its autopilot.
/// @throws UsageError for an unknown robot, or what check_limits() says.
SafetyLimits limits_for(const scenario::Scenario& scenario, const std::string& robot);

/// @throws UsageError with name and rule for a limit that is not finite, not positive or not below
/// the next step of its ladder.
void check_limits(const SafetyLimits& limits);

}  // namespace vantage::drivers
