#pragma once

#include "core/deadline.hpp"
#include "planner/decision/decision.hpp"

namespace vantage::planner {

struct DistributedOptions {
  double alpha = 1.0;
  /// True: tries candidates by descending individual value and skips those that cannot improve.
  /// Ignored if the information is not submodular, because skipping is then unsound.
  bool lazy = true;
  /// True: the search starts with additions only; each is the best addition of the whole team.
  bool warm_start = true;
};

/// Distributed local search, simulated for a team. Its robots make one oracle call per tick and
/// receive all messages without delay. The first valid proposal stops all searches and is adopted
/// by all; if there are several in one tick, is_preferred() selects one. The search ends when no
/// robot has a proposal. The result is a local optimum of the neighbourhood of
/// centralised_local_search and has the same guarantee. Oracle calls count the work of all robots
/// until they were stopped. The deadline counts oracle calls as nodes.
/// Source: dissertation Alg. 7 and 8 (with the arg max of line 15), section 3.C.5.
TeamDecision distributed_local_search(const TeamOracle& oracle, const DistributedOptions& options,
                                      const Deadline& deadline);

}  // namespace vantage::planner
