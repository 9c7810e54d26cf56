#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "scenario/reader/overrides.hpp"
#include "tools/compare/comparison.hpp"

namespace vantage::tools {

/// Trials of one scenario in virtual time: each planner with each seed.
struct TrialBatch {
  std::string scenario_path;
  scenario::Overrides overrides;  ///< overrides of all trials
  std::vector<std::string> planners;
  std::vector<std::uint64_t> seeds;
  /// Folder for the logs PLANNER_SEED.lcmlog; empty: no logs are written.
  std::string log_folder;
  int jobs = 1;  ///< number of threads
};

/// Reads a list of seeds: numbers and inclusive ranges, separated by commas ("1-10,20").
/// @throws StartupError for anything else, for more than 100 000 seeds and for a repeated seed
std::vector<std::uint64_t> parse_seeds(const std::string& text);

/// Result of a batch.
struct BatchResult {
  std::vector<TrialGroup> groups;  ///< one group per planner; complete trials only
  std::vector<std::string> log_errors;
  std::int64_t collisions = 0;
  bool was_stopped = false;
};

/// Runs the trials. `on_trial(done, all)` is called after each trial, one call at a time. If `stop`
/// returns true, running trials end early and are left out.
/// @throws StartupError as run_trial()
BatchResult run_batch(const TrialBatch& batch, const std::function<bool()>& stop,
                      const std::function<void(int, int)>& on_trial);

}  // namespace vantage::tools
