#pragma once

#include <cstdint>

namespace vantage::scenario {

/// Number of search nodes per slot in virtual time if the scenario contains no node budget. Time
/// budgets do not apply in virtual time.
inline constexpr std::int64_t kDefaultNodeBudget = 20'000;

}  // namespace vantage::scenario
