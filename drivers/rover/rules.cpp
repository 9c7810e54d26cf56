#include "drivers/rover/rules.hpp"

#include <array>

#include "drivers/safety/latches.hpp"

namespace vantage::drivers {
namespace {

using models::FlightState;
using models::OperatorAction;
using In = SafetyInputs;
using Lim = SafetyLimits;
constexpr auto kKill = Severity::kKill;
constexpr auto kHold = Severity::kHold;
constexpr auto kNote = Severity::kNote;
constexpr auto kAtOnce = Clearing::kAtOnce;
constexpr auto kSelf = Clearing::kSelf;
constexpr auto kOperator = Clearing::kOperator;
constexpr auto kRearm = Clearing::kRearm;

constexpr const char* kSelfRule = "by itself, gone for clear_s";
constexpr const char* kOperatorRule = "gone, and the operator says follow";
constexpr const char* kRearmRule = "standing, gone, and the operator says arm";

constexpr auto
    kRows =
        std::to_array<Condition>(
            {
                // KILL: the rover's own emergency stop
                {"emergency stop", kKill, kRearm, true, 0.0,
                 "any station asked, or the rover's own is latched", kRearmRule,
                 [](const In& in, const Lim&) { return in.emergency_stop; }},
                {"motor", kKill, kRearm, true, 0.0, "the rover reports a failed motor", kRearmRule,
                 [](const In& in, const Lim&) { return in.motor_failed; }},
                {"fence far", kKill, kRearm, true, 0.0, "centre > fence_kill_m outside", kRearmRule,
                 [](const In& in, const Lim& lim) {
                   return in.fence_centre_m < -lim.fence_kill_m;
                 }},
                // HOLD
                {"pose lost", kHold, kOperator, true, 0.0, "pose_age_s > pose_age_land_s",
                 kOperatorRule,
                 [](const In& in, const Lim& lim) { return in.pose_age_s > lim.pose_age_land_s; }},
                {"pose stale", kHold, kSelf, true, 0.0, "pose_age_s > pose_age_hold_s", kSelfRule,
                 [](const In& in, const Lim& lim) { return in.pose_age_s > lim.pose_age_hold_s; }},
                {"pose late", kHold, kSelf, true, 0.0, "latency > pose_latency_hold_s", kSelfRule,
                 [](const In& in, const Lim& lim) {
                   return in.pose_latency_s > lim.pose_latency_hold_s;
                 }},
                {"pose implausible", kHold, kOperator, true, 0.0,
                 "pose_rejected_hold poses in a row", kOperatorRule,
                 [](const In& in, const Lim& lim) {
                   return in.poses_rejected >= lim.pose_rejected_hold;
                 }},
                {"fence", kHold, kOperator, true, 0.0, "edge > fence_land_m outside", kOperatorRule,
                 [](const In& in, const Lim& lim) { return in.fence_now_m < -lim.fence_land_m; }},
                {"fence ahead", kHold, kSelf, false, 0.0, "the braking way leaves the fence",
                 kSelfRule, [](const In& in, const Lim&) { return in.fence_stop_m < 0.0; }},
                {"obstacle ahead", kHold, kSelf, true, 0.0, "the braking way meets an obstacle",
                 kSelfRule, [](const In& in, const Lim&) { return in.obstacle_stop_m < 0.0; }},
                {"separation breach", kHold, kOperator, true, 0.0,
                 "nearest body < separation_land_m", kOperatorRule,
                 [](const In& in, const Lim& lim) {
                   return in.separation_now_m < lim.separation_land_m;
                 }},
                {"separation", kHold, kSelf, true, 0.0,
                 "braking now comes within separation_hold_m of a body",
                 "by itself, gone for clear_s; yield_s more for the later name of the two",
                 [](const In& in, const Lim& lim) {
                   return in.separation_stop_m < lim.separation_hold_m;
                 },
                 true},
                {"tracking lost", kHold, kOperator, false,
                 0.1, "tracking_error_m > tracking_land_m", kOperatorRule,
                 [](const In& in, const Lim& lim) {
                   return in.tracking_error_m > lim.tracking_land_m;
                 }},
                {"tracking", kHold, kSelf, false, 0.1, "tracking_error_m > tracking_hold_m",
                 kSelfRule,
                 [](
                     const In& in,
                     const Lim& lim) { return in.tracking_error_m > lim.tracking_hold_m; }},
                {"no plan", kHold, kAtOnce, false,
                 0.0, "no plan, or it has ended and plan_age_s > plan_age_hold_s",
                 "a plan passes the check and begins where the rover is",
                 [](const In& in, const Lim& lim) {
                   return !in.has_plan || (in.plan_ended && in.plan_age_s > lim.plan_age_hold_s);
                 }},
                {"planner late", kHold, kSelf, false, 0.0,
                 "plans_late_hold plans in a row after the deadline", kSelfRule,
                 [](const In& in, const Lim& lim) { return in.plans_late >= lim.plans_late_hold; }},
                {"map differs", kHold, kSelf, true, 0.0, "another scenario is announced", kSelfRule,
                 [](const In& in, const Lim&) { return in.map_differs; }},
                {"rover silent", kHold, kSelf, true, 0.0, "no telemetry for telemetry_age_hold_s",
                 kSelfRule,
                 [](const In& in,
                    const Lim& lim) { return in.heartbeat_age_s > lim.telemetry_age_hold_s; }},
                {"rover deaf", kHold, kSelf, true, 0.0, "no command taken for telemetry_age_hold_s",
                 kSelfRule,
                 [](const In& in,
                    const Lim& lim) { return in.telemetry_age_s > lim.telemetry_age_hold_s; }},
                {"rover disobeys", kHold, kOperator, true, 0.0,
                 "it takes commands from another driver", kOperatorRule,
                 [](const In& in, const Lim&) { return !in.autopilot_obeys; }},
                {"battery critical", kHold, kOperator, true, 3.0, "share < battery_land_share",
                 kOperatorRule,
                 [](const In& in,
                    const Lim& lim) { return in.battery_share < lim.battery_land_share; }},
                {"operator quiet", kHold, kOperator, true, 0.0,
                 "no heartbeat for operator_age_hold_s", kOperatorRule,
                 [](const In& in, const Lim& lim) {
                   return lim.needs_operator && in.operator_age_s > lim.operator_age_hold_s;
                 }},
                {"own stall", kHold, kSelf, false, 0.0, "stall_hold_s between two ticks", kSelfRule,
                 [](const In& in, const Lim& lim) {
                   return in.since_last_tick_s > lim.stall_hold_s;
                 }},
                // Said, and no change of state
                {"pose unsettled", kNote, kAtOnce, true, 0.0,
                 "fewer than pose_frames_to_arm plausible poses", "at once",
                 [](const In& in, const Lim& lim) {
                   return in.poses_accepted < lim.pose_frames_to_arm;
                 }},
                {"planner silent", kNote, kAtOnce, false, 0.0,
                 "leaseholder silent for plan_silent_warn_s", "at once",
                 [](const In& in, const Lim& lim) {
                   return in.planner_age_s > lim.plan_silent_warn_s;
                 }},
                {"two planners", kNote, kAtOnce, true, 0.0,
                 "a run without the lease spoke within the lease", "at once",
                 [](const In& in, const Lim&) { return in.second_planner; }},
                {"another version", kNote, kAtOnce, true, 0.0,
                 "a message of no type of ours, in the last other_version_clear_s", "at once",
                 [](const In& in, const Lim& lim) {
                   return in.other_version_age_s < lim.other_version_clear_s;
                 }},
                {"plans refused", kNote, kAtOnce, false, 0.0,
                 "the newest plan did not pass the check", "at once",
                 [](const In& in, const Lim&) { return in.plans_refused > 0; }},
                {"battery low", kNote, kAtOnce, false, 1.0, "share < battery_low_share", "at once",
                 [](const In& in, const Lim& lim) {
                   return in.battery_share < lim.battery_low_share;
                 }},
            });
static_assert(kRows.size() <= kConditionsMax);

void step_idle(LadderState& next, const SafetyInputs& inputs, const SafetyLimits& limits) {
  next.latched.reset();
  next.wants_follow = false;
  if (inputs.emergency_stop) {
    latch(next, kRows, inputs, limits);
    next.state = FlightState::kKilled;
  } else if (asks(inputs, OperatorAction::kArm) && arming_blocks(kRows, inputs, limits).none()) {
    next.state = FlightState::kHold;
  }
}

void step_driving(LadderState& next, const SafetyInputs& inputs, const RoverFacts& facts,
                  const SafetyLimits& limits) {
  latch(next, kRows, inputs, limits);
  if (acts(kRows, next.latched, kKill)) {
    next.state = FlightState::kKilled;
    next.wants_follow = false;
    return;
  }
  if (next.state == FlightState::kLand || asks(inputs, OperatorAction::kLand)) {
    next.state = facts.stands ? FlightState::kIdle : FlightState::kLand;
    next.wants_follow = false;
    return;
  }
  if (asks(inputs, OperatorAction::kFollow)) {
    next.wants_follow = true;
  } else if (asks(inputs, OperatorAction::kHold)) {
    next.wants_follow = false;
  }
  const bool may_follow = next.wants_follow && !acts(kRows, next.latched, kHold);
  next.state = may_follow ? FlightState::kFollow : FlightState::kHold;
}

void step_killed(LadderState& next, const SafetyInputs& inputs, const RoverFacts& facts) {
  // `arm` releases the rover's own stop (wants_armed tells the driver to ask it); idle when the
  // rover says that it is.
  if (inputs.emergency_stop) {
    next.wants_armed = false;
  } else if (asks(inputs, OperatorAction::kArm) && facts.stands) {
    next.wants_armed = true;
  }
  if (next.wants_armed && !facts.stop_latched && !holds_any(kRows, next, kRearm)) {
    next.state = FlightState::kIdle;
    next.wants_armed = false;
    next.latched.reset();
  }
}

}  // namespace

std::span<const Condition> rover_conditions() { return kRows; }

bool is_driving(FlightState state) {
  return state == FlightState::kFollow || state == FlightState::kHold ||
         state == FlightState::kLand;
}

LadderState step_rover_ladder(const LadderState& before, const SafetyInputs& inputs,
                              const RoverFacts& facts, const SafetyLimits& limits) {
  LadderState next = before;
  watch(next, kRows, inputs, limits);
  switch (before.state) {
    case FlightState::kIdle:
      step_idle(next, inputs, limits);
      break;
    case FlightState::kFollow:
    case FlightState::kHold:
    case FlightState::kLand:
      step_driving(next, inputs, facts, limits);
      break;
    case FlightState::kKilled:
      step_killed(next, inputs, facts);
      break;
  }
  return next;
}

}  // namespace vantage::drivers
