#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/angle.hpp"
#include "core/pose.hpp"
#include "models/camera/camera_model.hpp"

// Section `sensor.camera` of a robot as values: a camera that detects AprilTags.

namespace vantage::scenario {

/// Kind of body that carries a tag.
enum class TagCarrier {
  kTarget,    ///< a detection is a measurement of the target
  kLandmark,  ///< body at a known position, for the robot's own pose
  kRobot,     ///< teammate
};

/// AprilTag on a body or at a landmark of the lab.
struct TagSpec {
  int id = 0;            ///< number of the tag in its family
  double size_m = 0.16;  ///< m; side of the black square
  TagCarrier carrier = TagCarrier::kTarget;
  int body_id = 0;   ///< id of the target, or of the landmark or robot in the section `localizer`
  std::string body;  ///< name of the target or robot; empty for a landmark
  double height_m = 0.15;  ///< m; height of the tag above its body, only for simulated images
};

/// Camera of one robot.
struct CameraSpec {
  std::string robot;
  std::string source;            ///< folder:PATH (images), v4l2:DEVICE or simulated
  std::string simulated_folder;  ///< folder in memory with the images of a simulated camera
  /// Path of the calibration file; empty: the scenario contains the calibration, which is then in
  /// `inline_calibration`.
  std::string calibration_file;
  std::optional<models::CameraModel> inline_calibration;
  std::string family = "tag36h11";  ///< family of all tags
  Pose3 body_from_camera;
  double rate_hz = 0.0;              ///< largest rate of measurements; 0: one per planning step
  double corner_sigma_pixels = 0.2;  ///< 1σ of each coordinate of a tag's corner
  double attitude_sigma_rad = radians(0.1);  ///< 1σ of the camera's attitude in the world, per axis
  double exposure_s = 0.0;                   ///< s; exposure time if the device does not report it
  double readout_s = 0.0;  ///< s; from the end of the exposure to the device's stamp
  int hamming_max = 1;     ///< largest number of corrected bits of a tag
  std::vector<TagSpec> tags;
};

inline constexpr const char* kFolderSource = "folder:";
inline constexpr const char* kV4l2Source = "v4l2:";
inline constexpr const char* kSimulatedSource = "simulated";

/// Names of the supported tag families.
inline constexpr const char* kTagFamilies[] = {"tag36h11", "tag25h9", "tag16h5",
                                               "tagStandard41h12"};

}  // namespace vantage::scenario
