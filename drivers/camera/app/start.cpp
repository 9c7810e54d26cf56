#include "drivers/camera/app/start.hpp"

#include <optional>
#include <utility>

#include "core/check.hpp"
#include "drivers/camera/app/node.hpp"
#include "scenario/reader/camera_yaml.hpp"

namespace vantage::drivers {

std::unique_ptr<bus::Node> start_camera(bus::Bus& bus, const bus::Clock& clock,
                                        const scenario::Scenario& scenario,
                                        const std::string& robot) {
  const std::optional<scenario::CameraSpec> spec = scenario::camera_of(scenario, robot);
  if (!spec) {
    throw StartupError(scenario.name + ": robot " + robot +
                       " has no camera; set sensor.device: camera and sensor.camera");
  }
  const models::CameraModel camera = scenario::calibration_of(*spec);
  Result<std::unique_ptr<camera::TagDetector>> detector = camera::make_tag_detector(spec->family);
  if (!detector.ok()) {
    throw StartupError(detector.error().message);
  }
  return std::make_unique<CameraNode>(bus, clock, scenario, *spec, camera,
                                      std::move(detector).value(),
                                      camera::open_source(*spec, camera));
}

}  // namespace vantage::drivers
