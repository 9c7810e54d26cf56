#include "drivers/safety/ladder.hpp"

#include <chrono>

#include "drivers/safety/latches.hpp"

namespace vantage::drivers {
namespace {

using models::FlightState;
using models::OperatorAction;

constexpr double kStoppingS = 2.5;  // s; time for disarming and the heartbeat that reports it

void reset_to(LadderState& next, FlightState state) {
  next.state = state;
  next.wants_armed = false;
  next.arm = next.take_off = {};
  next.wants_follow = false;
}

void refuse(LadderState& next, Refusal::Order order, const Reasons& reasons) {
  next.refusal = {order, reasons};
  next.take_off = {};
  if (order == Refusal::Order::kArm) {
    next.arm = {};
    next.wants_armed = false;
  }
}

// Stores new commands that are obeyed later.
void take_orders(LadderState& next, const SafetyInputs& inputs) {
  if (is_requested(inputs, OperatorAction::kArm)) {
    next.arm = {true, inputs.now};
    next.forbidden_at = inputs.now - std::chrono::hours(1);  // earlier conditions do not count
    next.refusal = {};
  } else if (is_requested(inputs, OperatorAction::kTakeOff)) {
    next.refusal = {};
    if (next.arm.is_given) {
      next.take_off = {true, inputs.now};
    } else {
      refuse(next, Refusal::Order::kTakeOff, {});
    }
  } else if (is_requested(inputs, OperatorAction::kLand) ||
             is_requested(inputs, OperatorAction::kHold)) {
    next.arm = next.take_off = {};
    next.refusal = {};
  }
}

void step_idle(LadderState& next, const SafetyInputs& inputs, const SafetyLimits& limits) {
  next.latched.reset();
  next.wants_follow = false;
  if (inputs.emergency_stop || inputs.unordered_rise_m > limits.lift_other_rise_m) {
    latch(next, conditions(), inputs, limits);
    reset_to(next, FlightState::kKilled);
    return;
  }
  if (inputs.is_found_flying || inputs.is_found_landing) {
    latch(next, conditions(), inputs, limits);
    next.state = inputs.is_found_landing ? FlightState::kLand : FlightState::kHold;
    next.wants_armed = true;
    next.refusal = {};
    return;
  }
  take_orders(next, inputs);
  const auto has_waited = [&](const GroundOrder& order) {
    return to_seconds(inputs.now - order.waits_since) > limits.arm_wait_s;
  };
  const Reasons blocks = arming_blocks(inputs, limits);
  if (blocks.none()) {
    next.arm.waits_since = inputs.now;
    // Motors idle for at most lift_idle_s while another vehicle lifts: autopilots stop idle motors,
    // which ends the take-off command.
    const bool is_turn = !next.take_off.is_given || !inputs.is_lift_blocked;
    next.its_turn_at = is_turn ? inputs.now : next.its_turn_at;
    next.wants_armed =
        next.arm.is_given && to_seconds(inputs.now - next.its_turn_at) <= limits.lift_idle_s &&
        (next.wants_armed || to_seconds(inputs.now - next.forbidden_at) >= limits.clear_s);
  } else {
    next.forbidden_at = inputs.now;
    next.wants_armed = false;
    if (next.arm.is_given && (has_waited(next.arm) || needs_operator(conditions(), blocks))) {
      refuse(next, Refusal::Order::kArm, blocks);
    }
  }
  next.is_stopping = inputs.autopilot_armed && (next.is_stopping || !next.wants_armed);
  next.unwanted_at = next.wants_armed ? next.unwanted_at : inputs.now;
  if (!next.take_off.is_given) {
    return;
  }
  const bool may_stop = next.is_stopping && to_seconds(inputs.now - next.unwanted_at) < kStoppingS;
  const Reasons near = take_off_blocks(inputs, limits);
  if (inputs.is_lift_blocked) {
    next.take_off.waits_since = inputs.now;  // time spent waiting for the turn does not count
  } else if (has_waited(next.take_off)) {
    refuse(next, Refusal::Order::kTakeOff, near | blocks);
  } else if (next.wants_armed && inputs.autopilot_armed && !may_stop && near.none()) {
    next.state = FlightState::kHold;
    next.take_off = {};
  }
}

void step_airborne(LadderState& next, const SafetyInputs& inputs, const SafetyLimits& limits) {
  latch(next, conditions(), inputs, limits);
  if (acts(conditions(), next.latched, Severity::kKill)) {
    reset_to(next, FlightState::kKilled);
    return;
  }
  if (!inputs.autopilot_armed) {  // the vehicle has landed, or a pilot disarmed it
    reset_to(next, FlightState::kIdle);
    next.latched.reset();
    return;
  }
  if (is_requested(inputs, OperatorAction::kFollow)) {
    next.wants_follow = true;
  } else if (is_requested(inputs, OperatorAction::kHold)) {
    next.wants_follow = false;
  }
  if (next.state == FlightState::kLand || acts(conditions(), next.latched, Severity::kLand) ||
      is_requested(inputs, OperatorAction::kLand)) {
    next.state = FlightState::kLand;
    next.wants_follow = false;
    const bool is_down =
        inputs.height_m < limits.touch_height_m && inputs.pose_age_s < limits.pose_age_hold_s;
    next.wants_armed = next.wants_armed && !is_down;
    next.arm = next.take_off = {};
    return;
  }
  const bool may_follow = next.wants_follow && !acts(conditions(), next.latched, Severity::kHold);
  next.state = may_follow ? FlightState::kFollow : FlightState::kHold;
}

void step_killed(LadderState& next, const SafetyInputs& inputs) {
  const bool is_down = !inputs.autopilot_armed || inputs.heartbeat_age_s == kNever;
  if (is_requested(inputs, OperatorAction::kArm) && is_down &&
      !holds_any(conditions(), next, Clearing::kRearm)) {
    reset_to(next, FlightState::kIdle);
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
  return step_by_state(
      before, conditions(), inputs, limits,
      [&](LadderState& next) { step_idle(next, inputs, limits); },
      [&](LadderState& next) { step_airborne(next, inputs, limits); },
      [&](LadderState& next) { step_killed(next, inputs); });
}

Reasons arming_blocks(const SafetyInputs& inputs, const SafetyLimits& limits) {
  return arming_blocks(conditions(), inputs, limits);
}

Reasons take_off_blocks(const SafetyInputs& inputs, const SafetyLimits& limits) {
  return take_off_blocks(conditions(), inputs, limits);
}

}  // namespace vantage::drivers
