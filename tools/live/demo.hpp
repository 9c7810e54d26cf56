#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bus/transport/transport.hpp"
#include "logs/metrics/trial_summary.hpp"
#include "scenario/scenario.hpp"
#include "trial/recipe.hpp"

namespace vantage::tools {

struct DemoOptions {
  std::string directory = "demo-out";  ///< folder for log and pictures, created if missing
  bool live_table = false;             ///< redraw a table in place; else print a line every 5 s
  bool quiet = false;
  /// Called with the trial's bus before anything is published on it, to attach a viewer. The
  /// returned object lives until the trial ends.
  std::function<std::shared_ptr<void>(bus::InProcessHub&)> attach;
  /// Called immediately with warnings about the log; the trial continues.
  std::function<void(const std::string&)> warn = [](const std::string&) {};
};

struct DemoResult {
  logs::TrialSummary summary;
  std::string log_path;
  std::string svg_path;   ///< empty if it could not be written
  std::string png_path;   ///< empty if it could not be rendered
  std::string png_error;  ///< reason why no PNG was written, for example that a program is missing
  std::vector<std::string> failures;  ///< exceptions of nodes, and files that were not written
};

/// Runs and records a trial in real time in this process. Each node has its own thread and
/// transport. Ends after scenario.duration_s, or immediately if `stop` returns true or a node
/// fails; all messages sent until the end are recorded and summarised. If the log cannot be
/// written, calls options.warn and continues the trial.
/// @throws StartupError if a file cannot be created or a node refuses the scenario.
DemoResult run_demo(const scenario::Scenario& scenario,
                    const std::vector<trial::NodeRecipe>& recipes, const DemoOptions& options,
                    const std::function<bool()>& stop);

}  // namespace vantage::tools
