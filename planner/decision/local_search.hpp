#pragma once

#include "core/deadline.hpp"
#include "planner/decision/decision.hpp"

namespace vantage::planner {

/// Centralised local search: starts from the best single trajectory and applies Delete, Add or Swap
/// operations until none improves (ImprovementRule). Operations are tested in this order and by
/// ascending number; the first improving one is applied. The search is then repeated with the
/// chosen candidates removed from the ground set. Returns the better result. For submodular J:
/// g(S*) ≤ 4 (1 + α) g(S), g = J + O.
/// Cost: N (n + 1) oracle calls to verify that no operation improves. The deadline counts oracle
/// calls as nodes.
/// Source: dissertation Alg. 6; Lee et al. 2009, Thm 4.
TeamDecision centralised_local_search(const TeamOracle& oracle, double alpha,
                                      const Deadline& deadline);

}  // namespace vantage::planner
