#pragma once

#include <cstdint>

namespace vantage::scenario {

/// Nodes of a slot when a scenario states none and time budgets mean nothing: in virtual time.
inline constexpr std::int64_t kDefaultNodeBudget = 20'000;

}  // namespace vantage::scenario
