#pragma once

#include <limits>
#include <optional>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// What is left around the vehicle, now and if it braked now: distances of its edge; negative is
/// outside or in contact.
struct Surroundings {
  double fence_now_m = kNever;
  double fence_centre_m = kNever;  ///< of its centre, from the bounds and the ceiling
  double fence_stop_m = kNever;    ///< of the whole braking way
  double obstacle_stop_m = kNever;
  double separation_now_m = kNever;   ///< centre to centre, nearest body, less its uncertainty
  double separation_stop_m = kNever;  ///< least, when both brake now
  bool yields = false;                ///< the nearest body's vehicle goes first
};

/// Everything the ladder looks at, at one instant: ages, distances and facts, as plain numbers.
/// Ages are by the receiver's monotonic clock; kNever when nothing was heard. The defaults are
/// those of a healthy vehicle on the ground.
struct SafetyInputs : Surroundings {
  Time now{};  ///< monotonic; only differences matter
  double since_last_tick_s = 0.0;
  double processor_wait_s = 0.0;  ///< of our own thread, within the last second; 0: not counted

  // Pose.
  double pose_age_s = 0.0;          ///< since the last plausible one arrived
  double pose_latency_s = 0.0;      ///< arrival here less capture, as far as clocks can be compared
  int poses_rejected = 0;           ///< implausible ones in a row
  int poses_accepted = 1000;        ///< plausible ones in a row
  double height_m = 0.0;            ///< best known, above the ground
  double tracking_error_m = 0.0;    ///< from the reference, height included; 0 without one
  double speed_mps = 0.0;           ///< horizontal, as measured
  bool is_hold_restless = false;    ///< commanded to hover, and neither at rest nor at its position
  bool is_pose_distrusted = false;  ///< by a row that has acted in this flight
  double sink_error_m = 0.0;        ///< above the commanded height while it comes down, in the air
  double body_tilt_rad = 0.0;       ///< of the body's z axis from the vertical, by mocap
  double start_off_m = 0.0;         ///< from where its first flight begins, until it has flown
  double start_turn_rad = 0.0;      ///< the same of yaw

  // Plan.
  bool has_plan = true;                 ///< a checked plan is on the course
  bool plan_ended = false;              ///< it has come to its hover
  double plan_age_s = 0.0;              ///< since the newest plan passed the check
  double planner_age_s = 0.0;           ///< since the leaseholder's last message
  int plans_late = 0;                   ///< in a row
  int plans_refused = 0;                ///< in a row
  bool second_planner = false;          ///< a run without the lease spoke in the last seconds
  bool map_differs = false;             ///< planner and vehicle do not fly in the same scenario
  double other_version_age_s = kNever;  ///< since a message was heard that is of no type of ours

  // Taking off.
  bool is_lift_taken = false;         ///< another vehicle lifts, or has to before this one
  double unrisen_s = 0.0;             ///< since `take-off`, while the body has not risen
  double unproven_s = 0.0;            ///< in the hover of the first lift
  double other_risen_m = 0.0;         ///< another body, while this one should
  double lift_astray_m = 0.0;         ///< in the first lift, seen from above; now or at once
  double lift_climb_error_mps = 0.0;  ///< body against autopilot, in the first lift
  double lift_turn_error_radps = 0.0;
  double risen_untold_m = 0.0;    ///< armed and told to stand
  double near_m = kNever;         ///< who is beside or below soon, seen from above
  bool is_found_flying = false;   ///< armed and in the air, and it was not this driver's doing
  bool is_found_landing = false;  ///< the same, landing by itself

  // Vehicle.
  bool autopilot_armed = false;
  bool autopilot_obeys = true;    ///< it is in the mode that takes our set-points, or asked to be
  bool is_flown_by_hand = false;  ///< the autopilot is in a mode that a pilot flies
  double heartbeat_age_s = 0.0;
  double telemetry_age_s = 0.0;
  bool estimator_good = true;
  double estimate_error_m = 0.0;    ///< its position from the mocap's, height included
  double velocity_error_mps = 0.0;  ///< its velocity from the mocap's, in flight
  double attitude_error_rad = 0.0;  ///< its level from the mocap's
  double yaw_error_rad = 0.0;       ///< its yaw from the mocap's
  double tilt_rad = 0.0;
  bool motor_failed = false;
  double battery_share = 1.0;
  double battery_age_s = 0.0;
  double battery_unchanged_s = 0.0;  ///< in flight
  double flight_s = 0.0;             ///< since take-off

  // The driver's own process.
  bool is_ending = false;  ///< it was asked to end

  // Operator.
  double operator_age_s = 0.0;                    ///< since the heartbeat of the station in charge
  bool emergency_stop = false;                    ///< asked since the last tick, by anyone
  std::optional<models::OperatorAction> request;  ///< the station in charge, or a safer one
};

/// Whether the operator asks for `action` at this tick.
inline bool asks(const SafetyInputs& inputs, models::OperatorAction action) {
  return inputs.request.has_value() && *inputs.request == action;
}

}  // namespace vantage::drivers
