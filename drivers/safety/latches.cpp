#include "drivers/safety/latches.hpp"

namespace vantage::drivers {
namespace {

using models::OperatorAction;

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
      return is_requested(inputs, OperatorAction::kFollow);
    case Clearing::kGround:
    case Clearing::kRearm:
      return false;  // the change of state clears these conditions
  }
  return false;
}

}  // namespace

void watch(LadderState& next, std::span<const Condition> rows, const SafetyInputs& inputs,
           const SafetyLimits& limits) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool is_spared = rows[i].spares_pilot && inputs.is_flown_by_hand;
    const bool holds = !is_spared && rows[i].holds(inputs, limits);
    if (holds && !next.held[i]) {
      next.since[i] = inputs.now;
    } else if (!holds && next.held[i]) {
      next.gone_since[i] = inputs.now;
    }
    next.held[i] = holds;
  }
}

void latch(LadderState& next, std::span<const Condition> rows, const SafetyInputs& inputs,
           const SafetyLimits& limits) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (next.held[i] && to_seconds(inputs.now - next.since[i]) >= rows[i].after_s) {
      next.latched.set(i);
    } else if (next.latched[i] && is_cleared(rows[i], next, i, inputs, limits)) {
      next.latched.reset(i);
    }
  }
}

bool acts(std::span<const Condition> rows, const Reasons& latched, Severity severity) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (latched[i] && rows[i].severity == severity) {
      return true;
    }
  }
  return false;
}

bool holds_any(std::span<const Condition> rows, const LadderState& ladder, Clearing clearing) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (ladder.held[i] && rows[i].clearing == clearing) {
      return true;
    }
  }
  return false;
}

bool waits_for_more_than_a_plan(std::span<const Condition> rows, const Reasons& latched) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    // A condition that ends when a plan begins must not block plans.
    const bool ends_with_plan = rows[i].clearing == Clearing::kAtOnce;
    if (latched[i] && rows[i].severity != Severity::kNote && !ends_with_plan) {
      return true;
    }
  }
  return false;
}

Reasons arming_blocks(std::span<const Condition> rows, const SafetyInputs& inputs,
                      const SafetyLimits& limits) {
  Reasons out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    out[i] = rows[i].blocks_arming && rows[i].holds(inputs, limits);
  }
  return out;
}

Reasons take_off_blocks(std::span<const Condition> rows, const SafetyInputs& inputs,
                        const SafetyLimits& limits) {
  Reasons out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    out[i] = rows[i].blocks_take_off && rows[i].holds(inputs, limits);
  }
  return out;
}

bool needs_operator(std::span<const Condition> rows, const Reasons& reasons) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool is_operators =
        rows[i].clearing == Clearing::kOperator || rows[i].clearing == Clearing::kRearm;
    if (reasons[i] && is_operators) {
      return true;
    }
  }
  return false;
}

}  // namespace vantage::drivers
