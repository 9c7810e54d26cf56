#include "drivers/camera/tag_pose.hpp"

#include <cmath>
#include <random>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "drivers/camera/tag_detector.hpp"

namespace vantage::drivers::camera {
namespace {

using Corners = std::array<Eigen::Vector2d, 4>;

constexpr double kSize_m = 0.2;

models::CameraModel lab_camera() {
  models::CameraModel camera;
  camera.focal_x_pixels = 420.0;
  camera.focal_y_pixels = 424.0;
  camera.distortion = {-0.12, 0.05, 0.0005, -0.0004, 0.0};
  return camera;
}

/// Returns the pose of a tag at `position_m` whose normal is tilted by `tilt_rad` from the line to
/// the camera, about an axis in the image at `axis_rad`.
Pose3 tag_at(const Eigen::Vector3d& position_m, double tilt_rad, double axis_rad, double turn_rad) {
  const Eigen::Quaterniond facing(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()));
  const Eigen::Quaterniond to_camera =
      Eigen::Quaterniond::FromTwoVectors(-Eigen::Vector3d::UnitZ(), -position_m);
  const Eigen::AngleAxisd tilt(
      tilt_rad, to_camera * Eigen::Vector3d(std::cos(axis_rad), std::sin(axis_rad), 0.0));
  return {position_m, Quaternion(tilt * to_camera * facing *
                                 Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()))};
}

Corners corners_of(const models::CameraModel& camera, const Pose3& camera_from_tag) {
  Corners out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = models::project(
                 camera, camera_from_tag * Eigen::Vector3d(0.5 * kSize_m * kTagCorners[i].x(),
                                                           0.5 * kSize_m * kTagCorners[i].y(), 0.0))
                 ->pixel;
  }
  return out;
}

Corners noisy(Corners corners, double sigma_pixels, std::mt19937_64& rng) {
  std::normal_distribution<double> noise(0.0, sigma_pixels);
  for (Eigen::Vector2d& corner : corners) {
    corner += Eigen::Vector2d(noise(rng), noise(rng));
  }
  return corners;
}

TEST(TagPose, RecoversTheExactPoseFromExactCorners) {
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < 300; ++i) {
    const Pose3 truth = tag_at({share(rng) - 0.5, share(rng) - 0.5, 0.5 + 3.0 * share(rng)},
                               1.4 * share(rng), 2.0 * kPi * share(rng), 2.0 * kPi * share(rng));
    const auto poses = estimate_poses(lab_camera(), kSize_m, corners_of(lab_camera(), truth), 0.1);
    ASSERT_TRUE(poses);
    EXPECT_NEAR((poses->best.camera_from_tag.translation_m - truth.translation_m).norm(), 0.0,
                1e-6);
    EXPECT_NEAR(poses->best.camera_from_tag.rotation.angularDistance(truth.rotation), 0.0, 1e-5);
  }
}

// Σ = σ² (JᵀJ)⁻¹ is compared with the covariance of the estimates from 3000 noisy images. Its
// ratio in any direction has a standard deviation of about √(2 / 3000) = 2.6 %.
TEST(TagPose, HasTheCovarianceOfNoisyEstimates) {
  constexpr int kImages = 3000;
  constexpr double kSigma_pixels = 0.1;
  const Pose3 truths[] = {tag_at({0.0, 0.0, 1.0}, 0.7, 0.0, 0.3),
                          tag_at({0.4, -0.3, 1.5}, 0.9, 1.0, 2.0),
                          tag_at({-0.6, 0.4, 1.2}, 1.2, 2.5, 4.0)};
  std::mt19937_64 rng(2);
  for (const Pose3& truth : truths) {
    const Corners exact = corners_of(lab_camera(), truth);
    using Vector6 = Eigen::Matrix<double, 6, 1>;
    Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
    for (int i = 0; i < kImages; ++i) {
      const auto poses =
          estimate_poses(lab_camera(), kSize_m, noisy(exact, kSigma_pixels, rng), kSigma_pixels);
      ASSERT_TRUE(poses);
      const Pose3& made = poses->best.camera_from_tag;
      const Eigen::AngleAxisd turn(made.rotation * truth.rotation.conjugate());
      Vector6 error;
      error << made.translation_m - truth.translation_m, turn.angle() * turn.axis();
      sum += error * error.transpose() / kImages;
    }
    const auto stated = estimate_poses(lab_camera(), kSize_m, exact, kSigma_pixels);
    ASSERT_TRUE(stated);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> ratios(
        sum, Eigen::Matrix<double, 6, 6>(stated->best.covariance));
    EXPECT_GT(ratios.eigenvalues().minCoeff(), 0.85);
    EXPECT_LT(ratios.eigenvalues().maxCoeff(), 1.15);
  }
}

// The two possible poses of a small tag have nearly the same corners and the same position.
TEST(TagPose, FindsBothPosesOfASmallTag) {
  const Pose3 truth = tag_at({0.2, 0.1, 4.0}, 0.6, 0.4, 1.0);
  const auto poses = estimate_poses(lab_camera(), kSize_m, corners_of(lab_camera(), truth), 0.2);
  ASSERT_TRUE(poses);
  ASSERT_TRUE(poses->second);
  EXPECT_LT(poses->second->error2_pixels2, 1.0);
  const Eigen::Vector3d other_normal =
      poses->second->camera_from_tag.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d to_camera = -truth.translation_m.normalized();
  EXPECT_NEAR(std::acos(other_normal.dot(to_camera)), 0.6, 0.1);
  const PositionOrFault found = position_of(*poses, 0.2);
  ASSERT_TRUE(found.position);
  EXPECT_LT((found.position->position_m - truth.translation_m).norm(), 0.05);
}

TEST(TagPose, RefusesCornersOfATagSeenFromBehind) {
  Corners corners = corners_of(lab_camera(), tag_at({0.0, 0.0, 1.0}, 0.5, 0.0, 0.0));
  std::swap(corners[0], corners[1]);
  std::swap(corners[2], corners[3]);
  EXPECT_FALSE(estimate_poses(lab_camera(), kSize_m, corners, 0.2));
}

TEST(TagPose, RefusesCornersOnALineOrAtOnePoint) {
  EXPECT_FALSE(estimate_poses(lab_camera(), kSize_m,
                              Corners{Eigen::Vector2d(1, 1), {2, 2}, {3, 3}, {4, 4}}, 0.2));
  EXPECT_FALSE(estimate_poses(lab_camera(), kSize_m,
                              Corners{Eigen::Vector2d(9, 9), {9, 9}, {9, 9}, {9, 9}}, 0.2));
}

// A partly hidden corner is detected 10 pixels away, which no pose of a square explains.
TEST(TagPosition, IsRefusedIfTheCornersAreNotThoseOfASquare) {
  Corners corners = corners_of(lab_camera(), tag_at({0.0, 0.0, 0.5}, 0.3, 0.0, 0.2));
  corners[2] += Eigen::Vector2d(10.0, -10.0);
  const auto poses = estimate_poses(lab_camera(), kSize_m, corners, 0.2);
  if (poses) {
    const PositionOrFault found = position_of(*poses, 0.2);
    ASSERT_FALSE(found.position);
    EXPECT_EQ(found.fault, PositionFault::kBadFit);
  }
}

TagPoses two_poses(double apart_m, double excess_pixels2) {
  TagPose best;
  best.camera_from_tag.translation_m = {0.0, 0.0, 1.0};
  best.covariance = 1e-4 * PoseCovariance::Identity();
  TagPose second = best;
  second.camera_from_tag.translation_m.x() += apart_m;
  second.error2_pixels2 = excess_pixels2;
  return {best, second};
}

// Two equally likely positions 4 cm apart, each with 1σ = 1 cm, agree: 0.04² / (2 · 1e-4) = 8 is
// below 11.34, the 99 % quantile of χ² with three degrees of freedom.
TEST(TagPosition, CoversBothPosesIfTheyAgree) {
  const PositionOrFault found = position_of(two_poses(0.04, 0.0), 0.2);
  ASSERT_TRUE(found.position);
  EXPECT_NEAR(found.position->position_m.x(), 0.02, 1e-12);
  EXPECT_NEAR(found.position->covariance_m2(0, 0), 1e-4 + 0.25 * 0.04 * 0.04, 1e-12);
  EXPECT_NEAR(found.position->covariance_m2(1, 1), 1e-4, 1e-12);
}

TEST(TagPosition, IsAmbiguousIfEquallyLikelyPosesDisagree) {
  const PositionOrFault found = position_of(two_poses(0.1, 0.0), 0.2);
  ASSERT_FALSE(found.position);
  EXPECT_EQ(found.fault, PositionFault::kAmbiguous);
}

// An excess of 20 σ² gives the second pose the weight exp(−10) = 4.5e-5.
TEST(TagPosition, IgnoresAnUnlikelyPose) {
  const PositionOrFault found = position_of(two_poses(0.1, 20.0 * 0.04), 0.2);
  ASSERT_TRUE(found.position);
  EXPECT_EQ(found.position->position_m.x(), 0.0);
}

}  // namespace
}  // namespace vantage::drivers::camera
