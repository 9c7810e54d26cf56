#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.hpp"
#include "tools/supervisor/supervisor.hpp"

namespace vantage::tools {

/// The name of the simulator among the processes.
inline constexpr const char* kSimProcess = "sim";

/// Longest time without a sign of life: of drivers and of the mocap driver, whose poses vehicles
/// need within 0.5 s, and of any other process.
inline constexpr double kDriverPatienceS = 0.8;
inline constexpr double kPatienceS = 3.2;

/// Where the processes of a trial find what they need.
struct ProcessPlaces {
  std::string executables;    ///< the folder of the vantage-* programs
  std::string scenario_path;  ///< what each of them reads
  std::string url;
  std::string host;                  ///< the one to run of scenario.hosts; empty: all there is
  bool has_virtual_targets = false;  ///< simulated, though every device is real
  std::string firmware_folder = {};  ///< under which each firmware works in a folder of its own
  std::vector<int> keep_open = {};   ///< descriptors that scenario_path needs
  int driver_priority = 0;  ///< SCHED_FIFO of vehicle drivers and of the mocap driver; 0: none
};

/// The robots that a driver process flies: those whose device is `wire` or `real`.
std::vector<std::string> robots_with_driver(const scenario::Scenario& scenario);

/// What is wrong with the scenario's mixture of devices, each a sentence; empty: it can be flown.
std::vector<std::string> device_faults(const scenario::Scenario& scenario);

/// The processes of a trial on this host, in an order for people to read (any order will do): the
/// simulator when anything is simulated, the firmware that flies simulated vehicles, the drivers of
/// devices that are not `direct`, the judge of real bodies' contacts when a robot is real, then per
/// robot sensor, estimator and planner. Essential are the simulator and the mocap driver: no
/// vehicle does anything worth while without them.
std::vector<ProcessSpec> process_plan(const scenario::Scenario& scenario,
                                      const ProcessPlaces& places);

}  // namespace vantage::tools
