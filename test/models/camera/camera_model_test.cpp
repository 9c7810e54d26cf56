#include "models/camera/camera_model.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace vantage::models {
namespace {

CameraModel distorted_camera() {
  CameraModel camera;
  camera.focal_x_pixels = 420.0;
  camera.focal_y_pixels = 424.0;
  camera.center_x_pixels = 325.0;
  camera.center_y_pixels = 236.0;
  camera.distortion = {-0.28, 0.09, 0.001, -0.0008, -0.01};
  return camera;
}

// Values of OpenCV's formula, computed by hand for one point: r² = 0.05, radial = 1 + 0.1 · 0.05.
TEST(CameraModel, ProjectsAsOpenCvDefines) {
  CameraModel camera;
  camera.distortion = {0.1, 0.0, 0.01, 0.02, 0.0};
  const auto seen = project(camera, {0.2, 0.4, 2.0});
  ASSERT_TRUE(seen);
  const double x = 0.1 * 1.005 + 2.0 * 0.01 * 0.02 + 0.02 * (0.05 + 2.0 * 0.01);
  const double y = 0.2 * 1.005 + 0.01 * (0.05 + 2.0 * 0.04) + 2.0 * 0.02 * 0.02;
  EXPECT_NEAR(seen->pixel.x(), 319.5 + 500.0 * x, 1e-9);
  EXPECT_NEAR(seen->pixel.y(), 239.5 + 500.0 * y, 1e-9);
}

TEST(CameraModel, HasTheJacobianOfTheProjection) {
  const CameraModel camera = distorted_camera();
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> side(-1.0, 1.0);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d point_m(side(rng), side(rng), 2.0 + side(rng));
    const auto seen = project(camera, point_m);
    ASSERT_TRUE(seen);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      constexpr double kStep_m = 1e-6;
      const Eigen::Vector3d step = kStep_m * Eigen::Vector3d::Unit(axis);
      const Eigen::Vector2d slope =
          (project(camera, point_m + step)->pixel - project(camera, point_m - step)->pixel) /
          (2.0 * kStep_m);
      EXPECT_NEAR((slope - seen->jacobian_per_m.col(axis)).norm(), 0.0, 1e-4);
    }
  }
}

TEST(CameraModel, UndistortsEveryPixelOfTheImage) {
  const CameraModel camera = distorted_camera();
  ASSERT_TRUE(is_invertible(camera));
  for (int row = 0; row < camera.height; row += 37) {
    for (int column = 0; column < camera.width; column += 37) {
      const auto ratio = undistort(camera, {column, row});
      ASSERT_TRUE(ratio);
      const auto back = project(camera, {ratio->x(), ratio->y(), 1.0});
      ASSERT_TRUE(back);
      EXPECT_NEAR(back->pixel.x(), column, 1e-8);
      EXPECT_NEAR(back->pixel.y(), row, 1e-8);
    }
  }
}

// r (1 − r²) has its maximum at r = 0.58, so larger distorted radii belong to no point.
TEST(CameraModel, RefusesDistortionThatFoldsTheImage) {
  CameraModel camera;
  camera.distortion = {-1.0, 0.0, 0.0, 0.0, 0.0};
  EXPECT_FALSE(is_invertible(camera));
  EXPECT_FALSE(undistort(camera, {639.0, 479.0}));
}

TEST(CameraModel, ProjectsNoPointBehindTheCamera) {
  EXPECT_FALSE(project(CameraModel(), {0.1, 0.1, -1.0}));
  EXPECT_FALSE(project(CameraModel(), {0.1, 0.1, 0.0}));
}

}  // namespace
}  // namespace vantage::models
