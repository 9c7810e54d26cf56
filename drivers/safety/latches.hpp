#pragma once

#include <span>
#include <string>
#include <vector>

#include "drivers/safety/conditions.hpp"
#include "drivers/safety/ladder.hpp"

// Functions that evaluate, latch and clear the rows of any table of conditions. `rows` has at most
// kConditionsMax entries and must not change during the life of a LadderState.

namespace vantage::drivers {

/// Updates the set of true conditions and the time since which each is true.
void watch(LadderState& next, std::span<const Condition> rows, const SafetyInputs& inputs,
           const SafetyLimits& limits);
/// Computes one tick of a ladder: calls watch(), then the function of the current state: `idle`,
/// `moving` (follow, hold, land) or `killed`, each called with (LadderState& next).
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
/// Sets and clears the acting conditions from the result of watch().
void latch(LadderState& next, std::span<const Condition> rows, const SafetyInputs& inputs,
           const SafetyLimits& limits);
/// True if a latched condition has this severity.
bool acts(std::span<const Condition> rows, const Reasons& latched, Severity severity);
/// True if a condition with this clearing rule is true now.
bool holds_any(std::span<const Condition> rows, const LadderState& ladder, Clearing clearing);
/// True if a latched condition would persist when a plan begins.
bool waits_for_more_than_a_plan(std::span<const Condition> rows, const Reasons& latched);
/// True if a latched condition stops the use of poses.
bool distrusts_pose(std::span<const Condition> rows, const Reasons& latched);
/// Returns the conditions that forbid arming now.
Reasons arming_blocks(std::span<const Condition> rows, const SafetyInputs& inputs,
                      const SafetyLimits& limits);
/// Returns the conditions that forbid taking off but not arming.
Reasons take_off_blocks(std::span<const Condition> rows, const SafetyInputs& inputs,
                        const SafetyLimits& limits);
/// True if only the operator can clear at least one of `reasons`.
bool needs_operator(std::span<const Condition> rows, const Reasons& reasons);
/// Returns the names of `reasons` in the order of `rows`. Allocates.
std::vector<std::string> names_of(std::span<const Condition> rows, const Reasons& reasons);

}  // namespace vantage::drivers
