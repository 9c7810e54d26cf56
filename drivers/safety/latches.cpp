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

/// True if a condition in `set` has the property `is(row)`.
template <class Is>
bool has_any(std::span<const Condition> rows, const Reasons& set, const Is& is) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (set[i] && is(rows[i])) {
      return true;
    }
  }
  return false;
}

/// Returns the conditions with the property `blocks` that are true now.
Reasons blocking(std::span<const Condition> rows, bool Condition::*blocks,
                 const SafetyInputs& inputs, const SafetyLimits& limits) {
  Reasons out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    out[i] = rows[i].*blocks && rows[i].holds(inputs, limits);
  }
  return out;
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
  return has_any(rows, latched, [&](const Condition& row) { return row.severity == severity; });
}

bool holds_any(std::span<const Condition> rows, const LadderState& ladder, Clearing clearing) {
  return has_any(rows, ladder.held, [&](const Condition& row) { return row.clearing == clearing; });
}

bool waits_for_more_than_a_plan(std::span<const Condition> rows, const Reasons& latched) {
  // A condition that ends when a plan begins must not block plans.
  return has_any(rows, latched, [](const Condition& row) {
    return row.severity != Severity::kNote && row.clearing != Clearing::kAtOnce;
  });
}

bool distrusts_pose(std::span<const Condition> rows, const Reasons& latched) {
  return has_any(rows, latched, [](const Condition& row) { return row.distrusts_pose; });
}

bool needs_operator(std::span<const Condition> rows, const Reasons& reasons) {
  return has_any(rows, reasons, [](const Condition& row) {
    return row.clearing == Clearing::kOperator || row.clearing == Clearing::kRearm;
  });
}

Reasons arming_blocks(std::span<const Condition> rows, const SafetyInputs& inputs,
                      const SafetyLimits& limits) {
  return blocking(rows, &Condition::blocks_arming, inputs, limits);
}

Reasons take_off_blocks(std::span<const Condition> rows, const SafetyInputs& inputs,
                        const SafetyLimits& limits) {
  return blocking(rows, &Condition::blocks_take_off, inputs, limits);
}

std::vector<std::string> names_of(std::span<const Condition> rows, const Reasons& reasons) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (reasons[i]) {
      out.emplace_back(rows[i].name);
    }
  }
  return out;
}

}  // namespace vantage::drivers
