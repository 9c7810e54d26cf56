#pragma once

#include "scenario/reader/mapping.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Reads the section `firmware` of a robot. Precondition: the robot's device and the section of its
/// vehicle are read.
void read_firmware(Mapping& from, RobotSpec& robot);

}  // namespace vantage::scenario
