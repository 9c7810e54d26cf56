#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/camera/camera_model.hpp"
#include "scenario/camera_spec.hpp"
#include "scenario/localizer_spec.hpp"
#include "scenario/reader/mapping.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Reads a section `camera` of a sensor, except the names of the tags' bodies.
void read_camera(Mapping& from, CameraSpec& camera);

/// Checks the cameras of all robots, and the bodies that carry the tags. Precondition: the other
/// sections of `scenario` have been read.
/// @throws StartupError "file:line: …"
void check_cameras(const Value& document, const Scenario& scenario,
                   const std::optional<LocalizerSpec>& localizer);

/// Returns the cameras of the robots with `sensor.device: camera`, in the order of the robots. Only
/// the camera's process and the start of processes need them, so Scenario does not contain them.
/// @throws StartupError when the scenario's text is invalid
std::vector<CameraSpec> cameras_of(const Scenario& scenario);

/// Returns the camera of `robot`; nullopt if its sensor is not a camera.
std::optional<CameraSpec> camera_of(const Scenario& scenario, const std::string& robot);

/// Reads a calibration as ROS (camera_info) and OpenCV write it. Keys without effect on tags are
/// ignored.
/// @throws StartupError "name:line: …"
models::CameraModel parse_calibration(const std::string& yaml, const std::string& name);

/// Returns the calibration of `camera`, from its file or from the scenario.
/// @throws StartupError when the file cannot be read or is invalid
models::CameraModel calibration_of(const CameraSpec& camera);

}  // namespace vantage::scenario
