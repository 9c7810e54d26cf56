#pragma once

#include <limits>
#include <optional>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// Returns the time from `then` to `now`, s; kNever without `then`.
inline double time_since_s(const std::optional<Time>& then, Time now) {
  return then ? to_seconds(now - *then) : kNever;
}

/// Distances from the vehicle to its surroundings, now and if it braked now. They are measured from
/// the vehicle's edge unless stated. Negative: outside the fence or inside an obstacle.
struct Surroundings {
  double fence_now_m = kNever;
  double fence_centre_m = kNever;  ///< m; from the vehicle's centre to bounds and ceiling
  double fence_stop_m = kNever;    ///< m; minimum distance along the braking path
  double obstacle_stop_m = kNever;
  /// m; centre distance to the nearest body, minus its uncertainty and its excess radius
  double separation_now_m = kNever;
  /// m; minimum distance while this vehicle brakes and the others brake or continue
  double separation_stop_m = kNever;
  bool yields = false;  ///< the nearest body is a vehicle with priority
};

/// All inputs of the ladder at one instant: ages, distances and flags. Ages are by the receiver's
/// monotonic clock; kNever before the first message. The defaults describe a healthy vehicle on the
/// ground.
struct SafetyInputs : Surroundings {
  Time now{};  ///< monotonic time; only differences are used
  double since_last_tick_s = 0.0;
  /// s; time in the last second that this thread waited for a processor; 0 if not measured
  double processor_wait_s = 0.0;

  // Inputs about the pose.
  double pose_age_s = 0.0;        ///< s since the arrival of the last plausible pose
  double pose_latency_s = 0.0;    ///< s; arrival minus capture time, if the clocks are comparable
  double pose_sigma_m = 0.0;      ///< m; 1σ of an estimated pose (POSE_R); 0: motion capture
  int poses_rejected = 0;         ///< number of consecutive implausible poses
  int poses_accepted = 1000;      ///< number of consecutive plausible poses
  double height_m = 0.0;          ///< m above the ground, by the best available source
  double tracking_error_m = 0.0;  ///< m; 3D distance from the set-point; 0 without a set-point
  double speed_mps = 0.0;         ///< m/s; horizontal speed by mocap
  /// true: commanded to hover, but the vehicle moves or is off its position
  bool is_hover_deviating = false;
  bool is_pose_distrusted = false;  ///< a condition that distrusts poses has acted in this flight
  double sink_error_m = 0.0;        ///< m above the commanded height during a descent in the air
  double body_tilt_rad = 0.0;       ///< rad; angle of the body z axis to the vertical, by mocap
  /// m; distance from the scenario's start, before the first flight
  double start_off_m = 0.0;
  /// rad; yaw difference from the scenario's start, before the first flight
  double start_turn_rad = 0.0;

  // Inputs about the plan.
  bool has_plan = true;        ///< the course follows a checked plan
  bool plan_ended = false;     ///< the plan has reached its final hover
  double plan_age_s = 0.0;     ///< s since the last accepted plan
  double planner_age_s = 0.0;  ///< s since the last message of the planner that holds the lease
  int plans_late = 0;          ///< number of consecutive late plans
  int plans_refused = 0;       ///< number of consecutive refused plans
  /// true: a planner without the lease published within the lease time
  bool second_planner = false;
  bool map_differs = false;             ///< planner and driver use different scenarios
  double other_version_age_s = kNever;  ///< s since the last message of an unknown type

  // Inputs about the take-off.
  bool is_lift_blocked = false;  ///< true: another vehicle is lifting, or must lift before this one
  double no_rise_s = 0.0;        ///< s; time since the take-off command; 0 once the body has risen
  double proof_pending_s = 0.0;  ///< s; time in the hover of the first lift
  /// m; rise of another robot's body while this vehicle has not risen
  double other_risen_m = 0.0;
  /// m; horizontal distance from the path of the first lift, now or after reaction_s
  double lift_deviation_m = 0.0;
  double lift_climb_error_mps = 0.0;  ///< m/s; mocap minus autopilot, in the first lift
  double lift_turn_error_radps = 0.0;
  double unordered_rise_m = 0.0;  ///< m; rise while armed without a take-off command
  /// m; minimum horizontal distance to a body within take_off_prediction_s. Stationary robots do
  /// not count.
  double near_m = kNever;
  bool is_found_flying = false;   ///< armed and in the air without a command of this driver
  bool is_found_landing = false;  ///< as is_found_flying, with the autopilot in its landing mode

  // Inputs about the vehicle.
  bool autopilot_armed = false;
  /// the autopilot is in the mode that accepts set-points, or that mode was not requested
  bool autopilot_obeys = true;
  bool is_flown_by_hand = false;  ///< a pilot controls the vehicle
  double heartbeat_age_s = 0.0;
  double telemetry_age_s = 0.0;
  bool estimator_good = true;
  double estimate_error_m = 0.0;  ///< m; 3D distance between autopilot and mocap position
  /// m/s; horizontal difference between autopilot and mocap, in flight
  double velocity_error_mps = 0.0;
  double attitude_error_rad = 0.0;  ///< rad; difference of the vertical between autopilot and mocap
  double yaw_error_rad = 0.0;       ///< rad; yaw difference between autopilot and mocap
  double tilt_rad = 0.0;
  bool motor_failed = false;
  double battery_share = 1.0;
  double battery_age_s = 0.0;
  double battery_unchanged_s = 0.0;  ///< s; flight time without a change of the battery value
  double flight_s = 0.0;             ///< s since the vehicle became airborne

  // Inputs about this process.
  bool is_ending = false;  ///< the driver received a request to end

  // Inputs about the operator.
  double operator_age_s = 0.0;  ///< s since the last heartbeat of the station in charge
  bool emergency_stop = false;  ///< emergency stop received since the last tick, from any station
  /// action requested by the station in charge; hold and land are accepted from any station
  std::optional<models::OperatorAction> request;
};

/// True if the operator requests `action` at this tick.
inline bool is_requested(const SafetyInputs& inputs, models::OperatorAction action) {
  return inputs.request.has_value() && *inputs.request == action;
}

}  // namespace vantage::drivers
