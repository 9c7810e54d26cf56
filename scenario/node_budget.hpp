#pragma once

#include <cstdint>

namespace vantage::scenario {

/// Nodes per slot in virtual time, where time budgets do not apply, if a scenario states no node
/// budget.
inline constexpr std::int64_t kDefaultNodeBudget = 20'000;

}  // namespace vantage::scenario
