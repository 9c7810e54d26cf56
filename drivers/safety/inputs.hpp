#pragma once

#include <limits>
#include <optional>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// Distances around the vehicle, now and if it braked now, measured from its edge unless stated.
/// Negative: outside the fence or inside an obstacle.
struct Surroundings {
  double fence_now_m = kNever;
  double fence_centre_m = kNever;  ///< m; of the centre, to bounds and ceiling
  double fence_stop_m = kNever;    ///< m; least along the braking path
  double obstacle_stop_m = kNever;
  double separation_now_m = kNever;  ///< m; centre distance to the nearest body, less its
                                     ///< uncertainty and its excess radius
  /// m; least while this vehicle brakes and the others brake or go on
  double separation_stop_m = kNever;
  bool yields = false;  ///< the vehicle of the nearest body has priority
};

/// All inputs of the ladder at one instant: ages, distances and flags. Ages are by the receiver's
/// monotonic clock; kNever when nothing was received. The defaults describe a healthy vehicle on
/// the ground.
struct SafetyInputs : Surroundings {
  Time now{};  ///< monotonic; only differences matter
  double since_last_tick_s = 0.0;
  /// s; time in the last second that our own thread waited for a processor; 0: not counted
  double processor_wait_s = 0.0;

  // Pose.
  double pose_age_s = 0.0;        ///< s since the arrival of the last plausible pose
  double pose_latency_s = 0.0;    ///< s; arrival less capture, as far as the clocks can be compared
  int poses_rejected = 0;         ///< consecutive implausible poses
  int poses_accepted = 1000;      ///< consecutive plausible poses
  double height_m = 0.0;          ///< m above the ground, by the best source available
  double tracking_error_m = 0.0;  ///< m from the reference, height included; 0 without a reference
  double speed_mps = 0.0;         ///< m/s; horizontal, by mocap
  bool is_hover_deviating = false;  ///< commanded to hover, but moves or is away from its position
  bool is_pose_distrusted = false;  ///< by a row that has acted in this flight
  double sink_error_m = 0.0;        ///< m above the commanded height during a descent in the air
  double body_tilt_rad = 0.0;       ///< rad; body z axis to the vertical, by mocap
  double start_off_m = 0.0;         ///< m from the start of the scenario, until it has flown
  double start_turn_rad = 0.0;      ///< rad; the same for yaw

  // Plan.
  bool has_plan = true;                 ///< the course follows a checked plan
  bool plan_ended = false;              ///< the plan has reached its final hover
  double plan_age_s = 0.0;              ///< s since the last accepted plan
  double planner_age_s = 0.0;           ///< s since the last message of the leaseholder
  int plans_late = 0;                   ///< consecutive
  int plans_refused = 0;                ///< consecutive
  bool second_planner = false;          ///< a run without the lease published within the lease time
  bool map_differs = false;             ///< planner and vehicle use different scenarios
  double other_version_age_s = kNever;  ///< s since a message of an unknown type was received

  // Taking off.
  bool is_lift_blocked = false;  ///< another vehicle lifts, or must lift before this one
  double no_rise_s = 0.0;        ///< s since take-off, while the body has not risen
  double proof_pending_s = 0.0;  ///< s in the hover of the first lift
  double other_risen_m = 0.0;    ///< m; rise of another robot's body before this one has risen
  /// m; horizontal distance from the path of the first lift, now or after reaction_s
  double lift_deviation_m = 0.0;
  double lift_climb_error_mps = 0.0;  ///< m/s; mocap against autopilot, in the first lift
  double lift_turn_error_radps = 0.0;
  double unordered_rise_m = 0.0;  ///< m; rise while armed without a take-off order
  double near_m = kNever;  ///< m; least horizontal distance to a body within take_off_prediction_s;
                           ///< standing robots excluded
  bool is_found_flying = false;   ///< armed and in the air without an order of this driver
  bool is_found_landing = false;  ///< the same, with the autopilot in its landing mode

  // Vehicle.
  bool autopilot_armed = false;
  /// it is in the mode that takes set-points, or that mode was not requested
  bool autopilot_obeys = true;
  bool is_flown_by_hand = false;  ///< the autopilot is in a mode that a pilot flies
  double heartbeat_age_s = 0.0;
  double telemetry_age_s = 0.0;
  bool estimator_good = true;
  double estimate_error_m = 0.0;    ///< m; autopilot position to mocap position, height included
  double velocity_error_mps = 0.0;  ///< m/s; horizontal, autopilot against mocap, in flight
  double attitude_error_rad = 0.0;  ///< rad; vertical by the autopilot against mocap
  double yaw_error_rad = 0.0;       ///< rad; yaw by the autopilot against mocap
  double tilt_rad = 0.0;
  bool motor_failed = false;
  double battery_share = 1.0;
  double battery_age_s = 0.0;
  double battery_unchanged_s = 0.0;  ///< s in flight without a change of the value
  double flight_s = 0.0;             ///< s since the vehicle became airborne

  // This process.
  bool is_ending = false;  ///< requested to end

  // Operator.
  double operator_age_s = 0.0;  ///< s since the last heartbeat of the station in charge
  bool emergency_stop = false;  ///< received since the last tick, from any station
  /// from the station in charge; hold and land from any station
  std::optional<models::OperatorAction> request;
};

/// True if the operator requests `action` at this tick.
inline bool is_requested(const SafetyInputs& inputs, models::OperatorAction action) {
  return inputs.request.has_value() && *inputs.request == action;
}

}  // namespace vantage::drivers
