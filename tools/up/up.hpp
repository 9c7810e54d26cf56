#pragma once

#include <functional>
#include <string>
#include <vector>

#include "logs/metrics/trial_summary.hpp"
#include "models/scenario/scenario.hpp"
#include "tools/supervisor/supervisor.hpp"

namespace vantage::tools {

struct UpOptions {
  std::string executables;  ///< the folder of the vantage-* programs
  std::string log_path;     ///< empty: no log
  bool quiet = false;
  RestartPolicy restarts;
};

struct UpResult {
  logs::TrialSummary summary;
  int restarts = 0;
  bool any_given_up = false;
  std::vector<std::string> killed;  ///< that did not end in time by themselves
};

/// Flies a scenario with one process for each node of this host, over scenario.network.url, until
/// scenario.duration_s is over or `stop`; restarts what dies. The log begins with SCENARIO.
/// @throws StartupError when the network, the logger or a program cannot be used.
UpResult run_up(const models::Scenario& scenario, const UpOptions& options,
                const std::function<bool()>& stop);

}  // namespace vantage::tools
