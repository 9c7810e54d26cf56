#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "drivers/camera/tag_detector.hpp"
#include "drivers/camera/tag_pose.hpp"
#include "models/camera/camera_model.hpp"
#include "models/exchange/messages.hpp"
#include "models/exchange/pose_messages.hpp"
#include "models/sensor/sensor.hpp"
#include "scenario/camera_spec.hpp"

namespace vantage::drivers::camera {

/// Tag of the scenario that was seen in an image, in the frame of the robot's body.
struct SeenTag {
  scenario::TagSpec tag;
  Pose3 body_from_tag;  ///< most likely pose of the tag
  Eigen::Vector3d position_body_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_body_m2 = Eigen::Matrix3d::Zero();
  double range_m = 0.0;  ///< m; horizontal distance from the body's origin
  double range_variance_m2 = 0.0;
  double bearing_rad = 0.0;  ///< rad, from the body's x axis
  double bearing_variance_rad2 = 0.0;
};

/// Numbers of dropped tags.
struct TagCounts {
  std::int64_t unknown = 0;      ///< tags with ids that are not in the scenario
  std::int64_t misread = 0;      ///< tags with too many corrected bits or too little contrast
  std::int64_t duplicate = 0;    ///< tags with an id that occurs several times in an image
  std::int64_t at_border = 0;    ///< tags too near the border of the image
  std::int64_t bad_fit = 0;      ///< tags whose corners are not those of a square
  std::int64_t ambiguous = 0;    ///< tags with two about equally likely positions
  std::int64_t out_of_view = 0;  ///< targets that cannot be seen according to the sensor model
};

/// Converter of the tags in one robot's images to its measurements. Pure: no clock, no device.
class TagObserver {
 public:
  TagObserver(scenario::CameraSpec spec, const models::CameraModel& camera,
              const models::SensorModel& sensor, int position_dim);

  /// Returns the detected tags that the scenario contains. Their covariances include the errors of
  /// the corners and of the camera's attitude.
  [[nodiscard]] std::vector<SeenTag> observe(const std::vector<DetectedTag>& tags);
  /// Adds the detections of targets to `out`. Precondition: the viewpoint of `out` is set.
  /// @param world_from_body  pose of the robot at the time of the exposure
  void add_targets(const std::vector<SeenTag>& tags, const Pose3& world_from_body,
                   models::RobotMeasurement& out);
  /// Returns the landmarks and teammates.
  [[nodiscard]] static std::vector<models::Sighting> sightings(const std::vector<SeenTag>& tags,
                                                               Time time);

  [[nodiscard]] const TagCounts& counts() const { return counts_; }
  [[nodiscard]] const scenario::CameraSpec& spec() const { return spec_; }
  [[nodiscard]] const models::CameraModel& camera() const { return camera_; }

 private:
  scenario::CameraSpec spec_;
  models::CameraModel camera_;
  models::SensorModel sensor_;
  int position_dim_;
  TagCounts counts_;
};

}  // namespace vantage::drivers::camera
