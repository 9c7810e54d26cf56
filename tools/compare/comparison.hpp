#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "experiments/sweep/sample.hpp"
#include "logs/analysis/log_analysis.hpp"
#include "logs/metrics/trial_summary.hpp"

namespace vantage::tools {

/// One value of a trial that is compared between trials.
struct ComparedValue {
  std::string name;             ///< name with its unit
  std::optional<double> value;  ///< nullopt: not known for this trial
};

/// Returns the compared values of a trial, in the order of printing.
std::vector<ComparedValue> quantities_of(const logs::TrialSummary& summary);
/// Returns the compared values of a log, which include OSPA and swaps.
std::vector<ComparedValue> quantities_of(const logs::LogAnalysis& analysis);

/// One trial of a group.
struct ComparedTrial {
  std::uint64_t seed = 0;
  std::vector<ComparedValue> quantities;
};

/// Trials that differ only by their seed.
struct TrialGroup {
  std::string name;
  std::vector<ComparedTrial> trials;
};

/// Returns the values of quantity `i` in a group; trials without a value are left out.
experiments::Sample sample_of(const TrialGroup& group, std::size_t i);

/// Returns, for each seed that both groups have, the difference `group` minus `base` of quantity
/// `i`. Trials with the same seed have the same targets, so these differences vary less than means.
experiments::Sample paired_differences(const TrialGroup& group, const TrialGroup& base,
                                       std::size_t i);

/// Returns a table with one column per group: means with 95 % confidence intervals (Student's t),
/// then the paired differences to the first group. Precondition: at
/// least one group, and at least one trial in each group.
std::vector<std::string> comparison_table(const std::vector<TrialGroup>& groups);
/// Returns the table's content as JSON, with the values of each trial.
nlohmann::ordered_json comparison_json(const std::vector<TrialGroup>& groups);
/// Returns an SVG picture: for each main quantity, the trials of each group as points, and the mean
/// with its interval.
std::string comparison_figure(const std::vector<TrialGroup>& groups, const std::string& title);

}  // namespace vantage::tools
