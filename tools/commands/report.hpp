#pragma once

#include <string>

#include "logs/metrics/trial_summary.hpp"
#include "logs/picture/scene.hpp"
#include "scenario/scenario.hpp"

namespace vantage::tools {

/// Prints the result of a trial: one JSON object on one line, or a table.
void report_summary(const scenario::Scenario& scenario, const logs::TrialSummary& summary,
                    bool as_json);

/// Writes `svg_path` and next to it a PNG if rsvg-convert is installed; otherwise prints a message
/// on stderr. Returns false, and prints the error, if a file could not be written.
[[nodiscard]] bool write_pictures(const std::string& svg_path, const scenario::Scenario& scenario,
                                  const logs::Scene& scene, const logs::TrialSummary& summary);

}  // namespace vantage::tools
