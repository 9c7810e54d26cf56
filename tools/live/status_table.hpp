#pragma once

#include <string>
#include <vector>

#include "logs/metrics/trial_metrics.hpp"
#include "logs/metrics/trial_summary.hpp"
#include "models/scenario/scenario.hpp"

namespace vantage::tools {

/// The state of a running trial as lines of text, all of the same number at all times: one per
/// target, one per robot, one of totals.
std::vector<std::string> status_table(const models::Scenario& scenario,
                                      const logs::TrialMetrics& metrics, double elapsed_s);

/// The same in one line.
std::string status_line(const logs::TrialMetrics& metrics, double elapsed_s);

/// The outcome of a trial for people.
std::vector<std::string> summary_table(const models::Scenario& scenario,
                                       const logs::TrialSummary& summary);

}  // namespace vantage::tools
