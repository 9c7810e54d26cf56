#pragma once

#include <functional>
#include <string>
#include <vector>

#include "logs/file/log_index.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"
#include "trial/replay/output_comparison.hpp"

namespace vantage::trial {

/// Node to replay: the planner, the estimator or the localizer of one robot.
struct ReplayTarget {
  enum class Kind { kPlanner, kEstimator, kLocalizer };
  Kind kind = Kind::kPlanner;
  std::string robot;
};

/// Parses "planner:Q1", "estimator:Q1" or "localizer:Q1". @throws UsageError for other texts, or
/// when `scenario` has no such robot.
ReplayTarget parse_replay_target(const std::string& text, const scenario::Scenario& scenario);

struct ReplayReport {
  OutputComparison outputs;
  std::vector<models::NamedCount> counters;  ///< counters of the replaying node
  std::int64_t events = 0;                   ///< log events passed to the node
  /// events not passed to the node: they lack the signature that the flight required
  std::int64_t refused = 0;
  /// true: the flight's keys are missing, so forged messages are passed to the node too
  bool lacks_keys = false;
  /// Returns the number of logged outputs that were not reproduced because an input is not in the
  /// log.
  [[nodiscard]] std::int64_t not_replayed() const {
    return outputs.logged() - (outputs.replayed() - outputs.unexpected());
  }
};

/// Reproduces the outputs of one node: runs its code in virtual time on exactly the inputs that
/// each logged output names, with the logged node budget. Compares the results with the log, bit
/// for bit.
ReplayReport replay_log(const logs::IndexedLog& log, const scenario::Scenario& scenario,
                        const ReplayTarget& target,
                        const std::function<void(double)>& progress = {});

}  // namespace vantage::trial
