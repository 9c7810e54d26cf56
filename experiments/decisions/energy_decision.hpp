#pragma once

#include <string>

#include "planner/decision/decision.hpp"
#include "planner/search/arvi.hpp"

namespace vantage::experiments {

/// Effort and result of one decision method in one trial.
struct Decided {
  std::string method;
  planner::Choice choice;
  double value = 0.0;  ///< J, nats
  /// oracle calls per candidate, including calls for single candidates if the method needs them
  double calls_per_candidate = 0.0;
  double adopted = 0.0;
  double messages = 0.0;
  double cpu_s = 0.0;
};
Decided local_search(const std::string& method, const planner::TeamOracle& oracle, bool lazy,
                     bool warm_start);
/// Runs coordinate descent in the robots' order, or in the reverse order.
Decided descent(const std::string& method, const planner::TeamOracle& oracle, bool is_last_first);

/// Returns the calling thread's candidate search, with capacity for every energy trial. Each thread
/// keeps its own search, because its 0.6 GB take longer to prepare than a trial.
planner::ReducedValueIteration& thread_search();

}  // namespace vantage::experiments
