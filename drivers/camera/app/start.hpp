#pragma once

#include <memory>
#include <string>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Opens the camera of `robot` and returns its node.
/// @throws StartupError if the robot has no camera, or its calibration or source is invalid
std::unique_ptr<bus::Node> start_camera(bus::Bus& bus, const bus::Clock& clock,
                                        const scenario::Scenario& scenario,
                                        const std::string& robot);

}  // namespace vantage::drivers
