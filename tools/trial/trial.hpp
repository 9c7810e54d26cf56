#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "logs/metrics/trial_summary.hpp"
#include "models/scenario/scenario.hpp"
#include "tools/picture/scene.hpp"
#include "tools/trial/recipe.hpp"

namespace vantage::tools {

/// Nodes of work a slot when the scenario states none: time budgets mean nothing in virtual time.
inline constexpr std::int64_t kDefaultNodeBudget = 20'000;

struct TrialOptions {
  std::string log_path;  ///< an LCM event log of everything, a new file; empty: none
  /// Called with the share of the trial that is done, about a hundred times.
  std::function<void(double)> progress;
  /// Asked about twice a second of the trial; true ends it there. The log and the summary are whole
  /// up to that instant.
  std::function<bool()> stop;
};

struct TrialResult {
  logs::TrialSummary summary;
  Scene scene;
  bool was_stopped = false;                       ///< before the scenario's duration
  std::optional<Error> log_error = std::nullopt;  ///< why the log is not whole; ended the trial
};

/// When virtual time starts: 1 700 000 000 s, rounded up to a whole planning round.
Time trial_start(const models::Scenario& scenario);

/// One trial in virtual time: a pure function of the scenario (its seed included) and the nodes.
/// Precondition: the scenario's planner.node_budget is positive.
/// A log that cannot be written any more ends it as `stop` does: the file ends with a whole event.
/// @throws StartupError when the log cannot be begun, or there is one at its path already, or a
///         node refuses the scenario.
TrialResult run_trial(const models::Scenario& scenario, const std::vector<NodeRecipe>& recipes,
                      const TrialOptions& options = {});

}  // namespace vantage::tools
