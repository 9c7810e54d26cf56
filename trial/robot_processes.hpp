#pragma once

#include <array>
#include <string>

namespace vantage::trial {

/// Processes that every robot has, by the last part of their program name (vantage-sensor). Nodes
/// that are due at the same instant are executed in this order.
inline constexpr std::array<const char*, 3> kRobotProcesses = {"sensor", "estimator", "planner"};

/// Returns the display name of a process: "planner Q1".
std::string process_name(const std::string& word, const std::string& robot);

/// Returns the node name of a process, which HEALTH_<name> contains: "PLANNER_Q1" for "planner Q1".
std::string node_name(std::string process);

}  // namespace vantage::trial
