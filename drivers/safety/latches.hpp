#pragma once

#include <span>

#include "drivers/safety/conditions.hpp"
#include "drivers/safety/ladder.hpp"

// How the rows of any table of conditions are watched, latched and cleared. `rows` are at most
// kConditionsMax and the same for the whole life of a LadderState.

namespace vantage::drivers {

/// Which conditions hold, and since when.
void watch(LadderState& next, std::span<const Condition> rows, const SafetyInputs& inputs,
           const SafetyLimits& limits);
/// One tick of a ladder: watches, then takes the step of the state that it is in: `idle`, `moving`
/// (following, holding, landing) or `killed`, each of (LadderState& next).
template <class Idle, class Moving, class Killed>
LadderState step_by_state(const LadderState& before, std::span<const Condition> rows,
                          const SafetyInputs& inputs, const SafetyLimits& limits, const Idle& idle,
                          const Moving& moving, const Killed& killed) {
  LadderState next = before;
  watch(next, rows, inputs, limits);
  switch (before.state) {
    case models::FlightState::kIdle:
      idle(next);
      break;
    case models::FlightState::kFollow:
    case models::FlightState::kHold:
    case models::FlightState::kLand:
      moving(next);
      break;
    case models::FlightState::kKilled:
      killed(next);
      break;
  }
  return next;
}
/// Sets and clears what acts, from what watch() saw.
void latch(LadderState& next, std::span<const Condition> rows, const SafetyInputs& inputs,
           const SafetyLimits& limits);
/// Whether anything latched is of that severity.
bool acts(std::span<const Condition> rows, const Reasons& latched, Severity severity);
/// Whether any condition holds now that clears this way.
bool holds_any(std::span<const Condition> rows, const LadderState& ladder, Clearing clearing);
/// Whether anything latched would not end by a plan beginning.
bool waits_for_more_than_a_plan(std::span<const Condition> rows, const Reasons& latched);
/// What forbids arming now.
Reasons arming_blocks(std::span<const Condition> rows, const SafetyInputs& inputs,
                      const SafetyLimits& limits);
/// What forbids taking off and not arming.
Reasons take_off_blocks(std::span<const Condition> rows, const SafetyInputs& inputs,
                        const SafetyLimits& limits);
/// Whether any of `reasons` is one that only the operator ends.
bool needs_operator(std::span<const Condition> rows, const Reasons& reasons);

}  // namespace vantage::drivers
