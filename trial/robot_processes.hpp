#pragma once

#include <array>
#include <string>

namespace vantage::trial {

/// What runs for every robot, whatever its devices: the words in the names of programs
/// (vantage-sensor), in the order in which nodes that are due at the same instant act.
inline constexpr std::array<const char*, 3> kRobotProcesses = {"sensor", "estimator", "planner"};

/// What people call such a process: "planner Q1".
std::string process_name(const std::string& word, const std::string& robot);

/// The name of a process's node, as on HEALTH_*: "PLANNER_Q1" of "planner Q1".
std::string node_name(std::string process);

}  // namespace vantage::trial
