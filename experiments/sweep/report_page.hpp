#pragma once

#include <string>

#include "experiments/sweep/manifest.hpp"
#include "experiments/sweep/sweep.hpp"

namespace vantage::experiments {

/// report.md: how it was run, the figures, ours beside the printed values, what was chosen. The
/// same rows give the same page.
std::string report_page(const SweepIdentity& identity, const std::string& what,
                        const SweepPlan& plan, const Summary& summary);

/// The command that repeats a run, or goes on with it.
std::string command_of(const SweepIdentity& identity, int trials);

}  // namespace vantage::experiments
