#pragma once

#include <array>
#include <string>

namespace vantage::trial {

/// Processes of every robot, whatever its devices: the words in the program names (vantage-sensor),
/// in the order in which nodes that are due at the same instant are executed.
inline constexpr std::array<const char*, 3> kRobotProcesses = {"sensor", "estimator", "planner"};

/// Returns the display name of a process: "planner Q1".
std::string process_name(const std::string& word, const std::string& robot);

/// Returns the name of a process's node, as on HEALTH_*: "PLANNER_Q1" for "planner Q1".
std::string node_name(std::string process);

}  // namespace vantage::trial
