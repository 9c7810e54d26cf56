#pragma once

#include "core/deadline.hpp"
#include "planner/decision/decision.hpp"

namespace vantage::planner {

/// Centralised local search: from the best single trajectory, Delete / Add / Swap while one of them
/// improves (ImprovementRule), the first found in that order and by number; then once more with
/// what was chosen taken out of the ground set; the better of the two.
/// For submodular J: g(S*) ≤ 4 (1 + α) g(S), g = J + O. Cost: N (n + 1) oracle calls to be sure
/// that nothing improves. The deadline counts oracle calls as nodes. Source: dissertation Alg. 6;
/// Lee et al. 2009, Thm 4.
TeamDecision centralised_local_search(const TeamOracle& oracle, double alpha,
                                      const Deadline& deadline);

}  // namespace vantage::planner
