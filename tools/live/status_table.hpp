#pragma once

#include <string>
#include <vector>

#include "logs/metrics/trial_metrics.hpp"
#include "logs/metrics/trial_summary.hpp"
#include "scenario/scenario.hpp"

namespace vantage::tools {

/// The state of a running trial as lines of text, all of the same number at all times: one per
/// target (of a team that maps one for all), one per robot, one of totals. In colour what is well,
/// to be watched or wrong.
std::vector<std::string> status_table(const scenario::Scenario& scenario,
                                      const logs::TrialMetrics& metrics, double elapsed_s,
                                      bool in_colour = false);

/// The same in one line.
std::string status_line(const logs::TrialMetrics& metrics, double elapsed_s);

/// The outcome of a trial for people.
std::vector<std::string> summary_table(const scenario::Scenario& scenario,
                                       const logs::TrialSummary& summary);

}  // namespace vantage::tools
