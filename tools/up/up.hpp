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
  bool fly = false;                  ///< arm, take off and follow at the start, land at the end
  bool has_virtual_targets = false;  ///< simulate the targets though every device is real
  RestartPolicy restarts;
};

struct UpResult {
  logs::TrialSummary summary;
  int restarts = 0;
  bool any_given_up = false;
  std::vector<std::string> killed;       ///< that did not end in time by themselves
  std::vector<std::string> never_flown;  ///< vehicles to be flown that followed no plan
  std::vector<std::string> left_flying;  ///< vehicles that were not at rest at the end
};

/// Flies a scenario with one process for each node of this host, over scenario.network.url, until
/// scenario.duration_s is over or `stop`; restarts what dies. The log begins with SCENARIO.
///
/// With `fly` it is the operator of the vehicles that have drivers: its commands and its heartbeat
/// are in the log, any other station may still hold, land or stop a vehicle, and the end (`stop`
/// just so) waits for the landings. What happens during these counts as a contact, not as part of
/// the trial.
/// @throws StartupError when the network, the logger or a program cannot be used, the devices do
///         not fit together, or `fly` is asked for a real robot: these are armed by a person.
UpResult run_up(const models::Scenario& scenario, const UpOptions& options,
                const std::function<bool()>& stop);

}  // namespace vantage::tools
