#include "drivers/rover/rules.hpp"

#include <array>

#include "drivers/safety/common_conditions.hpp"
#include "drivers/safety/latches.hpp"

namespace vantage::drivers {
namespace {

using models::FlightState;
using models::OperatorAction;
using In = SafetyInputs;
using Lim = SafetyLimits;

constexpr const char* kStandingRule = "stationary, fault ended, and the operator sends arm";

constexpr auto kRows = std::to_array<Condition>({
    // KILL: the rover's own emergency stop
    cleared(limited(common::kEmergencyStop,
                    "a station requested the stop, or the rover's stop is latched"),
            kStandingRule),
    cleared(limited(common::kMotor, "the rover reports a failed motor"), kStandingRule),
    cleared(limited(common::kFenceFar, "the rover's centre is > fence_kill_m outside the fence"),
            kStandingRule),
    // Conditions that cause HOLD.
    held_for_operator(common::kPoseLost),
    held_for_operator(common::kPoseVeryUncertain),
    common::kPoseUncertain,
    common::kPoseStale,
    common::kPoseLate,
    common::kPoseImplausible,
    limited(held_for_operator(common::kFence),
            "the rover's edge is > fence_land_m outside the fence"),
    common::kFenceAhead,
    common::kObstacleAhead,
    held_for_operator(common::kSeparationBreach),
    common::kSeparation,
    held_for_operator(common::kTrackingLost),
    common::kTracking,
    cleared(common::kNoPlan, "a plan passes the check and begins where the rover is"),
    common::kPlannerLate,
    common::kMapDiffers,
    holds(
        "rover silent", "no telemetry for telemetry_age_hold_s", {.blocks_arming = true},
        [](const In& in, const Lim& lim) { return in.heartbeat_age_s > lim.telemetry_age_hold_s; }),
    holds(
        "commands not accepted", "the rover has accepted no command for telemetry_age_hold_s",
        {.blocks_arming = true},
        [](const In& in, const Lim& lim) { return in.telemetry_age_s > lim.telemetry_age_hold_s; }),
    holds_for_operator("rover disobeys", "the rover accepts commands from another driver",
                       {.blocks_arming = true},
                       [](const In& in, const Lim&) { return !in.autopilot_obeys; }),
    held_for_operator(common::kBatteryCritical),
    common::kOperatorQuiet,
    cleared(held_for_operator(common::kEnding),
            "never: the driver ends once the rover is stationary"),
    common::kDriverStalled,
    held_for_operator(common::kShortOfProcessor),
    common::kWaitsForProcessor,
    // The rows below are reported without a change of state.
    common::kPoseUnsettled,
    common::kPlannerSilent,
    common::kTwoPlanners,
    common::kAnotherVersion,
    common::kPlansRefused,
    common::kBatteryLow,
    common::kHostBusy,
});
static_assert(kRows.size() <= kConditionsMax);

void step_idle(LadderState& next, const SafetyInputs& inputs, const SafetyLimits& limits) {
  next.latched.reset();
  next.wants_follow = false;
  if (inputs.emergency_stop) {
    latch(next, kRows, inputs, limits);
    next.state = FlightState::kKilled;
  } else if (is_requested(inputs, OperatorAction::kArm) &&
             arming_blocks(kRows, inputs, limits).none()) {
    next.state = FlightState::kHold;
  }
}

void step_driving(LadderState& next, const SafetyInputs& inputs, const RoverFacts& facts,
                  const SafetyLimits& limits) {
  latch(next, kRows, inputs, limits);
  if (acts(kRows, next.latched, Severity::kKill)) {
    next.state = FlightState::kKilled;
    next.wants_follow = false;
    return;
  }
  if (next.state == FlightState::kLand || is_requested(inputs, OperatorAction::kLand)) {
    next.state = facts.is_stationary ? FlightState::kIdle : FlightState::kLand;
    next.wants_follow = false;
    return;
  }
  if (is_requested(inputs, OperatorAction::kFollow)) {
    next.wants_follow = true;
  } else if (is_requested(inputs, OperatorAction::kHold)) {
    next.wants_follow = false;
  }
  const bool may_follow = next.wants_follow && !acts(kRows, next.latched, Severity::kHold);
  next.state = may_follow ? FlightState::kFollow : FlightState::kHold;
}

void step_killed(LadderState& next, const SafetyInputs& inputs, const RoverFacts& facts) {
  // `arm` releases the rover's own stop (wants_armed makes the driver request it); the state
  // becomes idle when the rover reports the release.
  if (inputs.emergency_stop) {
    next.wants_armed = false;
  } else if (is_requested(inputs, OperatorAction::kArm) && facts.is_stationary) {
    next.wants_armed = true;
  }
  if (next.wants_armed && !facts.stop_latched && !holds_any(kRows, next, Clearing::kRearm)) {
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
  return step_by_state(
      before, kRows, inputs, limits, [&](LadderState& next) { step_idle(next, inputs, limits); },
      [&](LadderState& next) { step_driving(next, inputs, facts, limits); },
      [&](LadderState& next) { step_killed(next, inputs, facts); });
}

}  // namespace vantage::drivers
