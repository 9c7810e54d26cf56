#include "drivers/quadrotor/safety/ladder.hpp"

#include "drivers/quadrotor/safety/latches.hpp"

namespace vantage::drivers {
namespace {

using models::FlightState;
using models::OperatorAction;

void come_to_rest(LadderState& next, FlightState state) {
  next.state = state;
  next.wants_armed = false;
  next.wants_follow = false;
}

void step_idle(LadderState& next, const SafetyInputs& inputs, const SafetyLimits& limits) {
  next.latched.reset();
  next.wants_follow = false;
  if (inputs.emergency_stop) {
    latch(next, conditions(), inputs, limits);
    come_to_rest(next, FlightState::kKilled);
    return;
  }
  const bool may = arming_blocks(inputs, limits).none();
  if (asks(inputs, OperatorAction::kArm)) {
    next.wants_armed = true;
  } else if (asks(inputs, OperatorAction::kLand) || asks(inputs, OperatorAction::kHold)) {
    next.wants_armed = false;
  }
  next.wants_armed = next.wants_armed && may;
  if (asks(inputs, OperatorAction::kTakeOff) && next.wants_armed && inputs.autopilot_armed) {
    next.state = FlightState::kHold;
  }
}

void step_airborne(LadderState& next, const SafetyInputs& inputs, const SafetyLimits& limits) {
  latch(next, conditions(), inputs, limits);
  if (acts(conditions(), next.latched, Severity::kKill)) {
    come_to_rest(next, FlightState::kKilled);
    return;
  }
  if (!inputs.autopilot_armed) {  // landed, or the pilot took the motors away
    come_to_rest(next, FlightState::kIdle);
    next.latched.reset();
    return;
  }
  if (asks(inputs, OperatorAction::kFollow)) {
    next.wants_follow = true;
  } else if (asks(inputs, OperatorAction::kHold)) {
    next.wants_follow = false;
  }
  if (next.state == FlightState::kLand || acts(conditions(), next.latched, Severity::kLand) ||
      asks(inputs, OperatorAction::kLand)) {
    next.state = FlightState::kLand;
    next.wants_follow = false;
    const bool is_down =
        inputs.height_m < limits.touch_height_m && inputs.pose_age_s < limits.pose_age_hold_s;
    next.wants_armed = next.wants_armed && !is_down;
    return;
  }
  const bool may_follow = next.wants_follow && !acts(conditions(), next.latched, Severity::kHold);
  next.state = may_follow ? FlightState::kFollow : FlightState::kHold;
}

void step_killed(LadderState& next, const SafetyInputs& inputs) {
  const bool is_down = !inputs.autopilot_armed || inputs.heartbeat_age_s == kNever;
  if (asks(inputs, OperatorAction::kArm) && is_down &&
      !holds_any(conditions(), next, Clearing::kRearm)) {
    come_to_rest(next, FlightState::kIdle);
    next.latched.reset();
  }
}

}  // namespace

bool is_airborne(FlightState state) {
  return state == FlightState::kFollow || state == FlightState::kHold ||
         state == FlightState::kLand;
}

LadderState step_ladder(const LadderState& before, const SafetyInputs& inputs,
                        const SafetyLimits& limits) {
  LadderState next = before;
  watch(next, conditions(), inputs, limits);
  switch (before.state) {
    case FlightState::kIdle:
      step_idle(next, inputs, limits);
      break;
    case FlightState::kFollow:
    case FlightState::kHold:
    case FlightState::kLand:
      step_airborne(next, inputs, limits);
      break;
    case FlightState::kKilled:
      step_killed(next, inputs);
      break;
  }
  return next;
}

Reasons arming_blocks(const SafetyInputs& inputs, const SafetyLimits& limits) {
  return arming_blocks(conditions(), inputs, limits);
}

}  // namespace vantage::drivers
