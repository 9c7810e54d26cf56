#pragma once

#include <functional>
#include <string>
#include <vector>

#include "logs/file/log_index.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"
#include "trial/replay/output_comparison.hpp"

namespace vantage::trial {

/// One robot's planner or estimator.
struct ReplayTarget {
  enum class Kind { kPlanner, kEstimator };
  Kind kind = Kind::kPlanner;
  std::string robot;
};

/// "planner:Q1" or "estimator:Q1". @throws UsageError for anything else, or when `scenario` has no
/// such robot.
ReplayTarget parse_replay_target(const std::string& text, const scenario::Scenario& scenario);

struct ReplayReport {
  OutputComparison outputs;
  std::vector<models::NamedCount> counters;  ///< of the replaying node
  std::int64_t events = 0;                   ///< fed to it
  std::int64_t refused =
      0;  ///< left out: not signed with the flight's keys, where it asked for that
  bool lacks_keys = false;  ///< the flight's keys are not here: what it refused is fed, too
  /// Logged outputs that were not made again, because an input is not in the log.
  [[nodiscard]] std::int64_t not_replayed() const {
    return outputs.logged() - (outputs.replayed() - outputs.unexpected());
  }
};

/// Makes the outputs of one node again: the node's own code, on exactly the inputs that each logged
/// output names, with the node budget that it states, in virtual time. What it says is compared
/// with what the log says, bit for bit.
ReplayReport replay_log(const logs::IndexedLog& log, const scenario::Scenario& scenario,
                        const ReplayTarget& target,
                        const std::function<void(double)>& progress = {});

}  // namespace vantage::trial
