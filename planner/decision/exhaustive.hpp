#pragma once

#include <vector>

#include "planner/decision/decision.hpp"

namespace vantage::planner {

/// The choice of largest J over `robots` (the others get nothing), each with one candidate or none.
/// Of equals the first by number. Cost: Π (|Mᵢ| + 1) oracle calls: for small teams and as the
/// oracle of tests.
TeamDecision exhaustive_optimum(const TeamOracle& oracle, const std::vector<int>& robots);

/// max over choices of min over attacks on at most `attacks_max` robots of J, by enumeration: the
/// optimum of robust trajectory planning. Every robot that has candidates is given one, which
/// loses nothing where J never falls when a trajectory is added.
/// Source: dissertation Problem 7. Cost: Π |Mᵢ| · Σ_{k≤α} C(n, k).
TeamDecision exhaustive_max_min(const TeamOracle& oracle, int attacks_max);

}  // namespace vantage::planner
