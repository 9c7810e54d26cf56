#pragma once

#include <string>
#include <vector>

#include "models/scenario/scenario.hpp"
#include "tools/supervisor/supervisor.hpp"

namespace vantage::tools {

/// Where the processes of a trial find what they need.
struct ProcessPlaces {
  std::string executables;    ///< the folder of the vantage-* programs
  std::string scenario_path;  ///< what each of them reads
  std::string url;
  bool has_virtual_targets = false;  ///< simulated, though every device is real
};

/// The robots that a driver process flies: those whose device is `wire` or `real`.
std::vector<std::string> robots_with_driver(const models::Scenario& scenario);

/// What is wrong with the scenario's mixture of devices, each a sentence; empty: it can be flown.
std::vector<std::string> device_faults(const models::Scenario& scenario);

/// The processes of a trial on this host, in the order of starting: the simulator when anything is
/// simulated, the drivers of devices that are not `direct`, then per robot sensor, estimator and
/// planner.
std::vector<ProcessSpec> process_plan(const models::Scenario& scenario,
                                      const ProcessPlaces& places);

/// lcm-logger writing to `log_path`, over what is there.
ProcessSpec logger_process(const std::string& url, const std::string& log_path);

}  // namespace vantage::tools
