#pragma once

#include <array>
#include <string>
#include <vector>

#include "scenario/scenario.hpp"

namespace vantage::trial {

/// Processes that every robot has, as the last part of the program's name ("sensor" for
/// vantage-sensor). Nodes that are due at the same instant are executed in this order.
inline constexpr std::array<const char*, 3> kRobotProcesses = {"sensor", "estimator", "planner"};

/// Process of the robots in the scenario's section `localizer`.
inline constexpr const char* kLocalizerProcess = "localizer";

/// All processes of a robot, in the order of execution.
inline constexpr std::array<const char*, 4> kProcessOrder = {
    kLocalizerProcess, kRobotProcesses[0], kRobotProcesses[1], kRobotProcesses[2]};

/// Returns the processes of kProcessOrder that vantage runs for `robot`: those of kRobotProcesses
/// that no process of the user replaces (`device: external`), and its localizer, if any.
std::vector<std::string> own_processes(const scenario::Scenario& scenario,
                                       const scenario::RobotSpec& robot);

/// Refuses a scenario in which a process of the user replaces one of vantage, because a trial
/// within one process cannot run other programs.
/// @throws StartupError that names the key
void require_own_processes(const scenario::Scenario& scenario);

/// Returns the display name of a process: "planner Q1".
std::string process_name(const std::string& word, const std::string& robot);

/// Returns the node name of a process, which HEALTH_<name> contains: "PLANNER_Q1" for "planner Q1".
std::string node_name(std::string process);

}  // namespace vantage::trial
