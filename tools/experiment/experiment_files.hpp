#pragma once

#include <string>
#include <vector>

#include "tools/experiment/experiment.hpp"

namespace vantage::tools {

/// Runs `experiment` and writes its files, manifest.json and figures (where gnuplot is there) into
/// `directory`, made if need be. Returns what to tell.
/// @throws StartupError when a file cannot be written
std::vector<std::string> run_experiment(const Experiment& experiment,
                                        const ExperimentOptions& options,
                                        const std::string& directory);

}  // namespace vantage::tools
