#include "drivers/quadrotor/safety/ladder.hpp"

namespace vantage::drivers {
namespace {

using models::FlightState;
using models::OperatorAction;

bool asks(const SafetyInputs& inputs, OperatorAction action) {
  return inputs.request.has_value() && *inputs.request == action;
}

// Which conditions hold, and since when.
void watch(LadderState& next, const SafetyInputs& inputs, const SafetyLimits& limits) {
  const auto rows = conditions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool holds = rows[i].holds(inputs, limits);
    if (holds && !next.held[i]) {
      next.since[i] = inputs.now;
    } else if (!holds && next.held[i]) {
      next.gone_since[i] = inputs.now;
    }
    next.held[i] = holds;
  }
}

bool is_cleared(const Condition& row, const LadderState& ladder, std::size_t i,
                const SafetyInputs& inputs, const SafetyLimits& limits) {
  if (ladder.held[i]) {
    return false;
  }
  switch (row.clearing) {
    case Clearing::kAtOnce:
      return true;
    case Clearing::kSelf: {
      const double wait_s = limits.clear_s + (row.yields && inputs.yields ? limits.yield_s : 0.0);
      return to_seconds(inputs.now - ladder.gone_since[i]) >= wait_s;
    }
    case Clearing::kOperator:
      return asks(inputs, OperatorAction::kFollow);
    case Clearing::kGround:
    case Clearing::kRearm:
      return false;  // by the change of state that ends them
  }
  return false;
}

// Sets and clears what acts in the air.
void latch(LadderState& next, const SafetyInputs& inputs, const SafetyLimits& limits) {
  const auto rows = conditions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (next.held[i] && to_seconds(inputs.now - next.since[i]) >= rows[i].after_s) {
      next.latched.set(i);
    } else if (next.latched[i] && is_cleared(rows[i], next, i, inputs, limits)) {
      next.latched.reset(i);
    }
  }
}

bool acts(const Reasons& latched, Severity severity) {
  const auto rows = conditions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (latched[i] && rows[i].severity == severity) {
      return true;
    }
  }
  return false;
}

bool holds_any(const LadderState& ladder, Clearing clearing) {
  const auto rows = conditions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (ladder.held[i] && rows[i].clearing == clearing) {
      return true;
    }
  }
  return false;
}

void come_to_rest(LadderState& next, FlightState state) {
  next.state = state;
  next.wants_armed = false;
  next.wants_follow = false;
}

void step_idle(LadderState& next, const SafetyInputs& inputs, const SafetyLimits& limits) {
  next.latched.reset();
  next.wants_follow = false;
  if (inputs.emergency_stop) {
    latch(next, inputs, limits);
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
  latch(next, inputs, limits);
  if (acts(next.latched, Severity::kKill)) {
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
  if (next.state == FlightState::kLand || acts(next.latched, Severity::kLand) ||
      asks(inputs, OperatorAction::kLand)) {
    next.state = FlightState::kLand;
    next.wants_follow = false;
    const bool is_down =
        inputs.height_m < limits.touch_height_m && inputs.pose_age_s < limits.pose_age_hold_s;
    next.wants_armed = next.wants_armed && !is_down;
    return;
  }
  const bool may_follow = next.wants_follow && !acts(next.latched, Severity::kHold);
  next.state = may_follow ? FlightState::kFollow : FlightState::kHold;
}

void step_killed(LadderState& next, const SafetyInputs& inputs) {
  const bool is_down = !inputs.autopilot_armed || inputs.heartbeat_age_s == kNever;
  if (asks(inputs, OperatorAction::kArm) && is_down && !holds_any(next, Clearing::kRearm)) {
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
  watch(next, inputs, limits);
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
  Reasons out;
  const auto rows = conditions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    out[i] = rows[i].blocks_arming && rows[i].holds(inputs, limits);
  }
  return out;
}

}  // namespace vantage::drivers
