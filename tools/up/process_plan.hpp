#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.hpp"
#include "tools/supervisor/supervisor.hpp"

namespace vantage::tools {

/// Process name of the simulator.
inline constexpr const char* kSimProcess = "sim";

/// s; longest time without a sign of life. kDriverPatienceS is for vehicle drivers and the mocap
/// driver, because vehicles need poses within 0.5 s; kPatienceS is for all other processes.
inline constexpr double kDriverPatienceS = 0.8;
inline constexpr double kPatienceS = 3.2;

/// Files, network and settings of the processes of a trial.
struct ProcessSettings {
  std::string executables;    ///< folder of the vantage-* programs
  std::string scenario_path;  ///< scenario file that each process reads
  std::string url;
  std::string host;                  ///< host of scenario.hosts to run; empty: everything
  bool has_virtual_targets = false;  ///< targets are simulated although every device is real
  std::string firmware_folder = {};  ///< folder with one working folder per firmware
  std::vector<int> keep_open = {};   ///< descriptors that scenario_path needs
  int driver_priority = 0;           ///< SCHED_FIFO priority of vehicle and mocap drivers; 0: none
};

/// Returns the robots that have a driver process: those with the device `wire` or `real`.
std::vector<std::string> robots_with_driver(const scenario::Scenario& scenario);

/// Returns one sentence for each fault in the scenario's combination of devices; empty if it can be
/// flown.
std::vector<std::string> device_faults(const scenario::Scenario& scenario);

/// Returns the processes of a trial on this host. They may be started in any order and are returned
/// in this order:
/// - the simulator, if anything is simulated;
/// - the firmware of simulated vehicles;
/// - `vantage ros2`, if the scenario has a section `ros2`;
/// - the mocap driver, if its device is not `direct` and ROS 2 does not replace it;
/// - the contact judge, if a robot is real;
/// - the vehicle drivers of robots, unless their device is `direct`;
/// - localizer (section `localizer`), sensor, estimator and planner of each robot.
/// The simulator and the publisher of VICON are essential: the trial ends without them.
std::vector<ProcessSpec> process_plan(const scenario::Scenario& scenario,
                                      const ProcessSettings& settings);

}  // namespace vantage::tools
