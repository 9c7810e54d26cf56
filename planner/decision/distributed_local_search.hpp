#pragma once

#include "core/deadline.hpp"
#include "planner/decision/decision.hpp"

namespace vantage::planner {

struct DistributedOptions {
  double alpha = 1.0;
  /// Candidates from the best alone on, and none that cannot improve. Ignored where information is
  /// not submodular, since giving up would then be unsound.
  bool lazy = true;
  /// First additions alone, each the best of the team.
  bool warm_start = true;
};

/// Distributed local search, as a team whose robots all make one oracle call at a time and hear
/// one another at once: the first valid proposal stops everybody and is adopted by all; of several
/// in the same tick is_preferred() takes one. Ends when nobody has a proposal: a local optimum of
/// the neighbourhood of centralised_local_search, with its guarantee. Calls count what all robots
/// did until they were stopped. The deadline counts oracle calls as nodes.
/// Source: dissertation Alg. 7, 8 (with the arg max of line 15), 3 C.5.
TeamDecision distributed_local_search(const TeamOracle& oracle, const DistributedOptions& options,
                                      const Deadline& deadline);

}  // namespace vantage::planner
