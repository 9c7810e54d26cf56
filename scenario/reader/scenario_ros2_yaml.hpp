#pragma once

#include <optional>

#include "scenario/reader/mapping.hpp"
#include "scenario/ros2_spec.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Reads the section `ros2`: connection to ROS 2 and the topics that are read from it.
/// Precondition: the other sections of `scenario` have been read.
void read_ros2(Mapping& from, const Scenario& scenario, Ros2Spec& ros2);

/// Returns the section `ros2` of the scenario's text; nullopt if there is none. Only `vantage ros2`
/// and the start of processes need this section, so Scenario does not contain it.
std::optional<Ros2Spec> ros2_of(const Scenario& scenario);

}  // namespace vantage::scenario
