#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

// Camera with a pinhole and lens distortion ("plumb bob"), as calibrated by OpenCV and ROS.
// Camera frame: x right, y down, z along the optical axis. The centre of the first pixel is (0, 0).

namespace vantage::models {

/// Intrinsic parameters of a camera.
struct CameraModel {
  int width = 640;   ///< pixels
  int height = 480;  ///< pixels
  double focal_x_pixels = 500.0;
  double focal_y_pixels = 500.0;
  double center_x_pixels = 319.5;
  double center_y_pixels = 239.5;
  /// Coefficients k1, k2, p1, p2, k3: radial, radial, tangential, tangential, radial.
  std::array<double, 5> distortion = {0.0, 0.0, 0.0, 0.0, 0.0};

  friend bool operator==(const CameraModel&, const CameraModel&) = default;
};

/// Pixel of a point, and ∂pixel/∂point.
struct ProjectedPoint {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> jacobian_per_m;
};

/// Returns the pixel of a point in the camera frame, which may be outside the image; nullopt if the
/// point is not in front of the camera.
std::optional<ProjectedPoint> project(const CameraModel& camera,
                                      const Eigen::Vector3d& point_camera_m);

/// Returns x / z and y / z of the points that are projected to `pixel`; nullopt if the distortion
/// cannot be inverted there.
std::optional<Eigen::Vector2d> undistort(const CameraModel& camera, const Eigen::Vector2d& pixel);

/// True if the distortion can be inverted in the complete image. A false result means wrong
/// coefficients.
bool is_invertible(const CameraModel& camera);

}  // namespace vantage::models
