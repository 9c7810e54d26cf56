#pragma once

#include <string>
#include <vector>

#include "logs/metrics/trial_metrics.hpp"
#include "logs/metrics/trial_summary.hpp"
#include "scenario/scenario.hpp"

namespace vantage::tools {

/// Returns the state of a running trial as lines of text: one per target, one per robot, one with
/// totals, and for a mapping team one for the map. The number of lines is constant in a trial.
/// With `in_colour`, good states, warnings and errors are coloured.
std::vector<std::string> status_table(const scenario::Scenario& scenario,
                                      const logs::TrialMetrics& metrics, double elapsed_s,
                                      bool in_colour = false);

/// Returns the state of a running trial as one line of text.
std::string status_line(const logs::TrialMetrics& metrics, double elapsed_s);

/// Returns the result of a trial as a table of text.
std::vector<std::string> summary_table(const scenario::Scenario& scenario,
                                       const logs::TrialSummary& summary);

}  // namespace vantage::tools
