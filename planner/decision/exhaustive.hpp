#pragma once

#include <vector>

#include "planner/decision/decision.hpp"

namespace vantage::planner {

/// Returns the choice with the greatest J over `robots`, each with one candidate or none; the other
/// robots get none. Of equal choices, returns the first by id. Cost: Π (|Mᵢ| + 1) oracle calls, so
/// it is only for small teams and as reference in tests.
TeamDecision exhaustive_optimum(const TeamOracle& oracle, const std::vector<int>& robots);

/// Maximises, over choices, the minimum J over attacks on at most `attacks_max` robots, by
/// enumeration: the optimum of robust trajectory planning. Every robot with candidates is assigned
/// one. This is optimal if J never decreases when a trajectory is added.
/// Source: dissertation Problem 7. Cost: Π |Mᵢ| · Σ_{k≤α} C(n, k).
TeamDecision exhaustive_max_min(const TeamOracle& oracle, int attacks_max);

}  // namespace vantage::planner
