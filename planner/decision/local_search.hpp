#pragma once

#include "core/deadline.hpp"
#include "planner/decision/decision.hpp"

namespace vantage::planner {

/// Centralised local search: starts from the best single trajectory and applies Delete, Add or Swap
/// operations until none improves (ImprovementRule). It applies the first improving operation in
/// that order and by number. It then repeats the search with the chosen candidates removed from the
/// ground set, and returns the better result. For submodular J: g(S*) ≤ 4 (1 + α) g(S), g = J + O.
/// Cost: N (n + 1) oracle calls to verify that no operation improves. The deadline counts oracle
/// calls as nodes.
/// Source: dissertation Alg. 6; Lee et al. 2009, Thm 4.
TeamDecision centralised_local_search(const TeamOracle& oracle, double alpha,
                                      const Deadline& deadline);

}  // namespace vantage::planner
