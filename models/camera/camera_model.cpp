#include "models/camera/camera_model.hpp"

#include <cmath>

#include <Eigen/LU>

namespace vantage::models {
namespace {

constexpr double kDepthMin_m = 1e-6;
constexpr int kIterationsMax = 30;
constexpr double kStepMax = 1e-12;  // the iteration ends at a smaller step, in x / z
constexpr int kBorderPoints = 32;   // tested points per side of the image

struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix2d jacobian;
};

/// Returns the distorted coordinates of `point` = (x / z, y / z) and their derivative.
Distorted distort(const CameraModel& camera, const Eigen::Vector2d& point) {
  const auto [k1, k2, p1, p2, k3] = camera.distortion;
  const double x = point.x();
  const double y = point.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double slope = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);  // ∂radial/∂r²
  Distorted out;
  out.point = {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
               y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
  const double mixed = 2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y;
  out.jacobian << radial + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, mixed,  //
      mixed, radial + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x;
  return out;
}

}  // namespace

std::optional<ProjectedPoint> project(const CameraModel& camera,
                                      const Eigen::Vector3d& point_camera_m) {
  const double depth_m = point_camera_m.z();
  if (!(depth_m > kDepthMin_m)) {
    return std::nullopt;
  }
  const Eigen::Vector2d ratio = point_camera_m.head<2>() / depth_m;
  const Distorted distorted = distort(camera, ratio);
  Eigen::Matrix<double, 2, 3> by_point;
  by_point << 1.0, 0.0, -ratio.x(),  //
      0.0, 1.0, -ratio.y();
  const Eigen::Vector2d focal(camera.focal_x_pixels, camera.focal_y_pixels);
  ProjectedPoint out;
  out.pixel = focal.cwiseProduct(distorted.point) +
              Eigen::Vector2d(camera.center_x_pixels, camera.center_y_pixels);
  out.jacobian_per_m = focal.asDiagonal() * (distorted.jacobian * by_point) / depth_m;
  return out;
}

std::optional<Eigen::Vector2d> undistort(const CameraModel& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d wanted((pixel.x() - camera.center_x_pixels) / camera.focal_x_pixels,
                               (pixel.y() - camera.center_y_pixels) / camera.focal_y_pixels);
  Eigen::Vector2d ratio = wanted;
  for (int i = 0; i < kIterationsMax; ++i) {
    const Distorted now = distort(camera, ratio);
    // The distortion is invertible where both eigenvalues of its derivative are positive.
    if (!(now.jacobian.determinant() > 0.0) || !(now.jacobian.trace() > 0.0)) {
      return std::nullopt;
    }
    const Eigen::Vector2d step = now.jacobian.inverse() * (wanted - now.point);
    ratio += step;
    if (!ratio.allFinite()) {
      return std::nullopt;
    }
    if (step.norm() < kStepMax * (1.0 + ratio.norm())) {
      return ratio;
    }
  }
  return std::nullopt;
}

bool is_invertible(const CameraModel& camera) {
  const double right = camera.width - 0.5;
  const double bottom = camera.height - 0.5;
  for (int i = 0; i <= kBorderPoints; ++i) {
    const double share = static_cast<double>(i) / kBorderPoints;
    const double column = -0.5 + share * (right + 0.5);
    const double row = -0.5 + share * (bottom + 0.5);
    for (const Eigen::Vector2d& pixel :
         {Eigen::Vector2d(column, -0.5), Eigen::Vector2d(column, bottom),
          Eigen::Vector2d(-0.5, row), Eigen::Vector2d(right, row)}) {
      if (!undistort(camera, pixel)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace vantage::models
