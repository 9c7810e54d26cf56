#include "drivers/safety/guard.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/check.hpp"
#include "drivers/safety/latches.hpp"
#include "drivers/safety/surroundings.hpp"

namespace vantage::drivers {

using models::FlightState;

namespace {

constexpr double kClearanceMps = 0.2;      // m/s; speed of a shift away from fence or obstacle
constexpr double kEstimatorGapMaxS = 0.2;  // s; longer than the gap of one lost estimator report
// reason in a status message that announces the first lift
constexpr const char* kFirstLift = "first lift";

/// Returns the share of the normal rate at which a plan is flown: 1 with a pose younger than
/// pose_age_warn_s, 0 from pose_age_hold_s on.
double plan_rate(const SafetyLimits& limits, double pose_age_s) {
  return std::clamp(
      (limits.pose_age_hold_s - pose_age_s) / (limits.pose_age_hold_s - limits.pose_age_warn_s),
      0.0, 1.0);
}

/// Returns the fields that describe the status of commands on the ground.
auto order_status(const LadderState& ladder) {
  return std::tuple(ladder.refusal, ladder.arm.is_given, ladder.take_off.is_given,
                    ladder.wants_armed);
}

// Appends the status of the commands `arm` and `take-off` on the ground.
void append_order_status(const LadderState& ladder, bool is_armed,
                         std::vector<std::string>& reasons) {
  if (ladder.arm.is_given && !ladder.wants_armed) {
    reasons.emplace_back("arm pending");
  }
  if (ladder.take_off.is_given) {
    reasons.emplace_back(is_armed ? "take-off pending" : "take-off pending: starting the motors");
  }
  if (ladder.refusal.order != Refusal::Order::kNone) {
    const bool is_arm = ladder.refusal.order == Refusal::Order::kArm;
    std::string why = is_arm ? "arm refused: " : "take-off refused: ";
    const std::vector<std::string> names = names_of(conditions(), ladder.refusal.reasons);
    for (std::size_t i = 0; i < names.size(); ++i) {
      why += (i == 0 ? "" : ", ") + names[i];
    }
    reasons.push_back(why + (names.empty() ? "not armed" : ""));
  }
}

}  // namespace

FlightGuard::FlightGuard(const scenario::Scenario& scenario, const std::string& robot,
                         const SafetyLimits& limits)
    // The window of the course limits changes of speed to the vehicle's braking deceleration.
    : core_(scenario, robot, limits, {conditions()},
            Course(half_window_s(limits.vehicle), limits.round_s)),
      take_off_(scenario, robot) {
  require(scenario.find_robot(robot) != nullptr,
          "flight safety: robot " + robot + " is not in the scenario");
  check_limits(limits);
}

bool FlightGuard::on_mocap(const models::MocapFrame& frame, Time now) {
  const bool airborne = is_airborne(core_.state());
  const SafetyLimits& limits = core_.limits();
  const BodyContext context{airborne, core_.course().at(now).velocity_world_mps.norm() > kMovingMps,
                            !airborne || core_.inputs().height_m < limits.safe_height_m,
                            is_descending() ? limits.descent_mps * core_.pose().age_s(now) : 0.0,
                            distrusts_pose_};
  return core_.on_mocap(frame, context, autopilot_.report().armed, now);
}

void FlightGuard::on_teammate_status(const models::VehicleStatus& status, Time now) {
  core_.on_teammate_status(status.robot, now);
  const bool is_lifting =
      std::find(status.reasons.begin(), status.reasons.end(), kFirstLift) != status.reasons.end();
  if (is_lifting && is_airborne(status.state)) {
    take_off_.queue().on_lifting(status.robot, now);
  }
}

CommandVerdict FlightGuard::on_command(const models::OperatorCommand& command, Time now) {
  using models::OperatorAction;
  if (!core_.admits(command, now)) {
    return core_.is_ours(command) ? CommandVerdict::kNotInCharge : CommandVerdict::kOtherRobot;
  }
  if (command.action == OperatorAction::kTakeOff) {
    // take-off commands to other robots are queued, too: robots lift one by one
    take_off_.queue().on_take_off(command.robot);
  }
  if (const auto verdict = core_.execute_if_stateless(command)) {
    return *verdict;
  }
  const bool airborne = is_airborne(core_.state());
  const bool on_ground_only =
      command.action == OperatorAction::kArm || command.action == OperatorAction::kTakeOff;
  const bool is_harmless = !on_ground_only && command.action != OperatorAction::kFollow;
  if (on_ground_only == airborne && !is_harmless) {
    return core_.refuse();
  }
  return core_.request_action(command.action);
}

bool FlightGuard::may_take_plans() const {
  const bool climbs = core_.state() == FlightState::kHold && take_off_.is_climbing();
  return core_.may_take_plans() && !climbs;
}

bool FlightGuard::is_descending() const {
  return core_.state() == FlightState::kLand && landing_.is_sinking();
}

// True if a landing has no position that it can use.
bool FlightGuard::is_blind() const {
  const SafetyInputs& in = core_.inputs();
  return distrusts_pose_ || in.pose_age_s > core_.limits().pose_age_kill_s ||
         autopilot_.estimator_gap_s(in.now) > kEstimatorGapMaxS;
}

// Returns the height error against the set-point, m. The error is 0 during a descent, and during a
// take-off at any height between start and goal.
double FlightGuard::height_error_m() const {
  const double at_m = core_.inputs().height_m;
  if (is_descending()) {
    return 0.0;
  }
  return take_off_.is_climbing() ? take_off_.height_error_m(at_m, height_.goal_m)
                                 : std::abs(at_m - height_.command_m);
}

// Fills the inputs with the state at `now`. The order matters: later inputs use earlier ones.
void FlightGuard::update_inputs(Time now) {
  started_at_ = started_at_.value_or(now);
  SafetyInputs& in = core_.inputs();
  in.autopilot_armed = autopilot_.is_assumed_armed(core_, now);
  core_.update_common_inputs(now);
  in.telemetry_age_s = autopilot_.telemetry_age_s(now);
  in.is_pose_distrusted = distrusts_pose_;
  update_height(now);
  detect_flight(now);
  update_ages(now);
  update_tracking_error(now);
  const auto bodies = core_.bodies(now);
  core_.update_surroundings(bodies, now);
  take_off_.update_inputs(core_, autopilot_.report(), bodies, now);
  autopilot_.update_inputs(core_, {take_off_.is_climbing(), is_descending()}, height_, now);
}

void FlightGuard::update_height(Time now) {
  SafetyInputs& in = core_.inputs();
  if (in.pose_age_s <= core_.limits().pose_age_hold_s) {
    in.height_m = height_.unmeasured_m = core_.position_m(now).z();
  } else {
    in.height_m = autopilot_.has_estimate(core_) ? autopilot_.report().position_world_m.z()
                                                 : height_.unmeasured_m;
  }
}

// Detects a vehicle in the air without a take-off by this driver: by mocap or, after a long time
// without a pose, by the autopilot's estimate.
void FlightGuard::detect_flight(Time now) {
  SafetyInputs& in = core_.inputs();
  const SafetyLimits& limits = core_.limits();
  const AutopilotReport& report = autopilot_.report();
  const bool is_idle = core_.state() == FlightState::kIdle;
  const bool has_recent_pose = in.pose_age_s <= limits.pose_age_hold_s;
  const bool is_unseen =
      std::min(in.pose_age_s, time_since_s(started_at_, now)) > limits.pose_age_land_s;
  const bool is_found = is_idle && !core_.ladder().wants_armed && in.autopilot_armed &&
                        in.telemetry_age_s <= limits.telemetry_age_hold_s &&
                        in.height_m - height_.ground_m.value_or(0.0) > limits.safe_height_m &&
                        (has_recent_pose || (is_unseen && autopilot_.has_estimate(core_)));
  if (is_idle && autopilot_.has_heartbeat() && !report.armed && has_recent_pose) {
    height_.ground_m = in.height_m;
  }
  in.is_found_flying = is_found && report.is_in_our_mode;
  in.is_found_landing = is_found && report.is_landing_itself;
  if (is_found) {
    take_off_.on_found_flying();
  }
}

// Fills the ages of messages. In the air, the age of a message that was never received counts from
// the start of this process, which may have begun just now.
void FlightGuard::update_ages(Time now) {
  SafetyInputs& in = core_.inputs();
  const bool airborne = is_airborne(core_.state());
  const bool is_flying = airborne || in.is_found_flying || in.is_found_landing;
  const auto age_s = [&](double since_s) {
    return since_s == kNever && is_flying ? time_since_s(started_at_, now) : since_s;
  };
  in.pose_age_s = age_s(in.pose_age_s);
  in.telemetry_age_s = age_s(in.telemetry_age_s);
  in.operator_age_s = age_s(in.operator_age_s);
  in.heartbeat_age_s = age_s(autopilot_.heartbeat_age_s(now));
  in.battery_age_s = age_s(autopilot_.battery_age_s(now));
  in.flight_s = airborne ? to_seconds(now - airborne_at_) : 0.0;
}

void FlightGuard::update_tracking_error(Time now) {
  SafetyInputs& in = core_.inputs();
  const bool has_recent_pose = core_.pose().age_s(now) <= core_.limits().pose_age_hold_s;
  in.speed_mps = has_recent_pose ? core_.pose().velocity_world_mps().head<2>().norm() : 0.0;
  in.tracking_error_m = 0.0;
  if (is_airborne(core_.state()) && has_recent_pose) {
    const Eigen::Vector3d commanded_m = core_.course().at(now).position_world_m;
    const Eigen::Vector3d on_time_m = core_.course().on_time(now).position_world_m;
    const double level_m = std::max((core_.position_m(now) - commanded_m).head<2>().norm(),
                                    (on_time_m - commanded_m).head<2>().norm());
    in.tracking_error_m = std::hypot(level_m, height_error_m());
  }
}

// Performs the actions that a change of state requires.
void FlightGuard::on_state_change(FlightState before, Time now) {
  const FlightState state = core_.state();
  const SafetyInputs& in = core_.inputs();
  if (!is_airborne(before) && is_airborne(state)) {
    airborne_at_ = now;
    const Pose3& here = core_.pose().world_from_body();
    core_.course().hover(here.translation_m, flatten(here).yaw_rad, now);
    height_.command_m = height_.goal_m = in.height_m;
    if (!in.is_found_flying && !in.is_found_landing) {
      take_off_.begin(core_, height_, now);
    }
  }
  const bool lands = state == FlightState::kLand && before != FlightState::kLand;
  const bool leaves_plan = before == FlightState::kFollow || (lands && core_.course().is_on_plan());
  if (leaves_plan && is_airborne(state)) {
    leave_plan(now);
  }
  if (lands || !is_airborne(state)) {
    take_off_.end();
  }
  if (lands) {
    landing_.begin(core_, height_, now);
  }
}

void FlightGuard::leave_plan(Time now) {
  Course& course = core_.course();
  if (core_.inputs().plan_ended && course.is_on_plan() && !course.has_next()) {
    // Hovers at the plan's final hover position, which was checked with the plan.
    const Setpoint end = course.at(now);
    course.hover(end.position_world_m, end.yaw_rad, now);
  } else {
    course.stop(core_.braking_path(now, 0.0), now);
  }
}

// Keeps the hover: stops a plan that may not be flown, and moves away from a fence or obstacle that
// a gust could make the vehicle touch.
void FlightGuard::hold(Time now) {
  Course& course = core_.course();
  const SafetyInputs& in = core_.inputs();
  if (!may_take_plans()) {
    // A plan accepted before a condition forbade plans must not start now.
    course.forget_next();
    if (course.is_on_plan()) {
      course.stop(core_.braking_path(now, 0.0), now);
    }
  }
  if (take_off_.is_lifting() || !course.is_hovering(now) ||
      in.pose_age_s > core_.limits().pose_age_warn_s || !in.estimator_good) {
    return;
  }
  // During a climb the course has the start height; the vehicle is higher.
  const Eigen::Vector3d hover_m = course.at(now).position_world_m;
  const Eigen::Vector3d here_m(hover_m.x(), hover_m.y(), in.height_m);
  if (const auto clear_m = clear_spot(here_m, core_.bodies(now), core_.limits())) {
    course.shift({clear_m->x(), clear_m->y(), hover_m.z()}, kClearanceMps, now);
  }
}

// Moves the vehicle as its state requires: hover, landing or commanded height.
void FlightGuard::move(double dt_s, Time now) {
  const SafetyLimits& limits = core_.limits();
  const FlightState state = core_.state();
  const double before_m = height_.command_m;
  if (state == FlightState::kHold) {
    hold(now);
  }
  if (state == FlightState::kLand) {
    landing_.step(core_, height_, is_blind(), dt_s, now);
  } else if (is_airborne(state)) {
    move_height(dt_s, now);
  }
  const double rate_mps = dt_s > 0.0 ? (height_.command_m - before_m) / dt_s : 0.0;
  height_.rate_mps = std::clamp(rate_mps, -limits.descent_mps, limits.climb_mps);
}

// Moves the commanded height to its goal.
void FlightGuard::move_height(double dt_s, Time now) {
  const SafetyLimits& limits = core_.limits();
  take_off_.step(core_, height_, now);
  if (core_.state() == FlightState::kFollow && core_.course().is_on_plan()) {
    height_.goal_m = core_.course().plan().height_m;
  }
  if (take_off_.is_waiting(core_, height_, now)) {
    return;
  }
  // The descent is limited to the velocity of the set-point.
  const double up_m = limits.climb_mps * dt_s;
  const double down_m = std::min(limits.climb_mps, limits.descent_mps) * dt_s;
  height_.command_m += std::clamp(height_.goal_m - height_.command_m, -down_m, up_m);
}

FlightSetpoint FlightGuard::setpoint(Time now) const {
  FlightSetpoint out;
  switch (core_.state()) {
    case FlightState::kIdle:
      return out;
    case FlightState::kKilled:
      out.kind = FlightSetpoint::Kind::kMotorsOff;
      return out;
    case FlightState::kLand:
      if (is_blind()) {
        out.kind = FlightSetpoint::Kind::kBlindLand;
        return out;
      }
      break;
    case FlightState::kFollow:
    case FlightState::kHold:
      break;
  }
  // Position and velocity refer to the same instant, so they are consistent. The acceleration has a
  // separate lead: the vehicle must tilt first, and a late acceleration causes a velocity error.
  const SafetyLimits& limits = core_.limits();
  const Setpoint soon = core_.course().at(now + from_seconds(limits.setpoint_lead_s));
  const Setpoint then = core_.course().at(now + from_seconds(limits.acceleration_lead_s));
  out.kind = FlightSetpoint::Kind::kTrack;
  static_cast<Setpoint&>(out) = soon;
  out.position_world_m.z() = height_.command_m + limits.setpoint_lead_s * height_.rate_mps;
  out.velocity_world_mps.z() = height_.rate_mps;
  out.acceleration_world_mps2 = then.acceleration_world_mps2;
  return out;
}

GuardOutput FlightGuard::tick(Time now) {
  const SafetyLimits& limits = core_.limits();
  const SafetyInputs& in = core_.inputs();
  const double dt_s = core_.dt_s(now);
  core_.course().advance(now, dt_s, plan_rate(limits, core_.pose().age_s(now)));
  update_inputs(now);
  stalls_ += in.since_last_tick_s > limits.stall_hold_s ? 1 : 0;

  const FlightState before = core_.state();
  const auto orders_before = order_status(core_.ladder());
  core_.set_ladder(step_ladder(core_.ladder(), in, limits));
  const LadderState& ladder = core_.ladder();
  distrusts_pose_ = is_airborne(ladder.state) && distrusts_pose(conditions(), ladder.latched);
  if (ladder.state != before) {
    on_state_change(before, now);
  }
  move(dt_s, now);
  if (!ladder.take_off.is_given && !take_off_.is_lifting()) {
    take_off_.queue().forget_own();
  }

  GuardOutput out;
  out.state = ladder.state;
  out.setpoint = setpoint(now);
  out.wants_armed = ladder.wants_armed;
  out.is_sinking = is_descending();
  out.climb_to_m = height_.goal_m;
  out.reasons = core_.acting_conditions();
  if (ladder.state == FlightState::kIdle && ladder.take_off.is_given) {
    out.reasons |= take_off_blocks(in, limits);
  }
  const bool has_other_reasons = core_.end_tick(out.reasons, now);
  out.changed = out.state != before || has_other_reasons || order_status(ladder) != orders_before;
  return out;
}

models::VehicleStatus FlightGuard::status(Time now) const {
  const bool is_lifting = take_off_.is_lifting();
  std::vector<std::string> details;
  if (is_lifting) {
    details.emplace_back(kFirstLift);
  } else if (core_.state() == FlightState::kHold && core_.reasons().none()) {
    details.emplace_back("operator");
  }
  if (core_.state() == FlightState::kIdle) {
    append_order_status(core_.ladder(), core_.inputs().autopilot_armed, details);
  }
  models::VehicleStatus out = core_.status(now, details);
  out.battery_share = autopilot_.battery_share();
  if (setpoint(now).kind == FlightSetpoint::Kind::kTrack) {
    out.setpoint_height_m = std::max(0.0, height_.command_m);
  } else {
    out.setpoint = flatten(core_.pose().world_from_body());
  }
  return out;
}

std::vector<models::NamedCount> FlightGuard::counters() const {
  std::vector<models::NamedCount> out;
  core_.count(out);
  out.push_back({"autopilot.refused", autopilot_.refused()});
  out.push_back({"tick.stalls", stalls_});
  return out;
}

}  // namespace vantage::drivers
