#pragma once

#include <memory>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "scenario/camera_spec.hpp"
#include "scenario/scenario.hpp"

namespace vantage::trial {

/// Returns the node of vantage-camera with a simulated camera: TRUTH gives the poses from which the
/// images are rendered, one per period of the measurements.
/// @throws StartupError if the program was built without the AprilTag library, or a tag is unknown
std::unique_ptr<bus::Node> simulated_camera(bus::Bus& bus, const bus::Clock& clock,
                                            const scenario::Scenario& scenario,
                                            const scenario::CameraSpec& spec);

}  // namespace vantage::trial
