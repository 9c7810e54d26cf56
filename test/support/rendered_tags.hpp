#pragma once

#include <array>
#include <cmath>
#include <random>
#include <string>

#include <Eigen/Geometry>

#include "core/angle.hpp"
#include "core/pose.hpp"
#include "drivers/camera/tag_detector.hpp"
#include "models/camera/camera_model.hpp"
#include "sim/camera/renderer.hpp"

namespace vantage::test {

inline constexpr double kRenderedSize_m = 0.2;

/// Returns a camera of 640 x 480 pixels with the distortion of a usual lens.
inline models::CameraModel rendered_camera() {
  models::CameraModel camera;
  camera.focal_x_pixels = 420.0;
  camera.focal_y_pixels = 422.0;
  camera.distortion = {-0.12, 0.05, 0.0005, -0.0004, 0.0};
  return camera;
}

/// Returns the pose of a camera at `height_m` that looks along x, down by `tilt_rad`.
inline Pose3 looking_down(double height_m, double tilt_rad) {
  Eigen::Matrix3d forward;
  forward << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return {{0.0, 0.0, height_m},
          Quaternion(Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitY()) *
                     Eigen::Quaterniond(forward))};
}

/// Returns a tag that lies face up at a point, turned by `yaw_rad`.
inline sim::PlacedTag lying_tag(int id, const Eigen::Vector3d& at_m, double yaw_rad) {
  return {sim::tag_pattern("tag36h11", id).value(), kRenderedSize_m,
          Pose3{at_m, Quaternion(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()))}};
}

/// Returns the true corners of a tag in the image.
inline std::array<Eigen::Vector2d, 4> true_corners(const models::CameraModel& camera,
                                                   const Pose3& world_from_camera,
                                                   const sim::PlacedTag& tag) {
  std::array<Eigen::Vector2d, 4> out;
  const Pose3 camera_from_tag = inverse(world_from_camera) * tag.world_from_tag;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Eigen::Vector2d& corner = drivers::camera::kTagCorners[i];
    const auto seen = models::project(
        camera, camera_from_tag * Eigen::Vector3d(0.5 * tag.size_m * corner.x(),
                                                  0.5 * tag.size_m * corner.y(), 0.0));
    out[i] = seen ? seen->pixel : Eigen::Vector2d(-1e9, -1e9);
  }
  return out;
}

/// Returns the smallest distance of the corners from the border of the image; negative outside.
inline double border_distance(const models::CameraModel& camera,
                              const std::array<Eigen::Vector2d, 4>& corners) {
  double out = 1e9;
  for (const Eigen::Vector2d& each : corners) {
    out = std::min({out, each.x() + 0.5, each.y() + 0.5, camera.width - 0.5 - each.x(),
                    camera.height - 0.5 - each.y()});
  }
  return out;
}

}  // namespace vantage::test
