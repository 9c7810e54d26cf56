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
  std::string directory = "demo-out";  ///< made when absent; log and pictures go there
  bool live_table = false;             ///< redraw in place; else a line each 5 s
  bool quiet = false;
  /// Called with the trial's bus before anything is published on it; what it returns lives until
  /// the trial is over. For someone to watch.
  std::function<std::shared_ptr<void>(bus::InProcessHub&)> attach;
  /// Told at once what is lost while it flies on.
  std::function<void(const std::string&)> warn = [](const std::string&) {};
};

struct DemoResult {
  logs::TrialSummary summary;
  std::string log_path;
  std::string svg_path;               ///< empty when it could not be written
  std::string png_path;               ///< empty when it could not be made
  std::string png_error;              ///< what is missing for it
  std::vector<std::string> failures;  ///< what nodes threw; what could not be written, and why
};

/// A trial in real time in this process: each node on a thread and endpoint of its own, everything
/// recorded. Ends after scenario.duration_s, or at once when `stop` says so or a node fails; what
/// was sent by then is recorded and summed up all the same. What cannot be written any more is told
/// and left out; it flies on.
/// @throws StartupError when a file cannot be begun or a node refuses the scenario.
DemoResult run_demo(const scenario::Scenario& scenario,
                    const std::vector<trial::NodeRecipe>& recipes, const DemoOptions& options,
                    const std::function<bool()>& stop);

}  // namespace vantage::tools
