#pragma once

#include <string>

#include "experiments/sweep/manifest.hpp"
#include "experiments/sweep/sweep.hpp"

namespace vantage::experiments {

/// Returns report.md: the command, the figures, the comparison with the printed values, and the
/// choices. Equal rows give equal pages.
std::string report_page(const SweepIdentity& identity, const std::string& what,
                        const SweepPlan& plan, const Summary& summary);

/// Returns the command that repeats or continues a run.
std::string command_of(const SweepIdentity& identity, int trials);

}  // namespace vantage::experiments
