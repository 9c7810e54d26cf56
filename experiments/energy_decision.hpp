#pragma once

#include <string>

#include "planner/decision/decision.hpp"
#include "planner/search/arvi.hpp"

namespace vantage::experiments {

/// What one way to decide took and found in one trial.
struct Decided {
  std::string method;
  planner::Choice choice;
  double value = 0.0;  ///< J, nats
  double calls_per_candidate =
      0.0;  ///< valuing each one alone included, where it must be asked for
  double adopted = 0.0;
  double messages = 0.0;
  double cpu_s = 0.0;
};
Decided local_search(const std::string& method, const planner::TeamOracle& oracle, bool lazy,
                     bool warm_start);
/// The robots choose in their order, or from the last to the first.
Decided descent(const std::string& method, const planner::TeamOracle& oracle, bool is_last_first);

/// The calling thread's own search for candidates, large enough for every energy trial: its 0.6 GB
/// take longer to prepare than a trial.
planner::ReducedValueIteration& own_search();

}  // namespace vantage::experiments
