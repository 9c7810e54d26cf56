#include "logs/metrics/pose_means.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/angle.hpp"

namespace vantage::logs {
namespace {

Time at(double s) { return from_utime(1'700'000'000'000'000) + from_seconds(s); }

models::TruthFrame truth(double s, const Pose2& pose) {
  models::TruthFrame frame;
  frame.stamp.time = at(s);
  frame.bodies = {{"Q1", -1, lift(pose, 1.0), Eigen::Vector3d::Zero()}};
  return frame;
}

models::PoseEstimate estimate(double s, const Pose2& pose, models::PoseSource source) {
  models::PoseEstimate out;
  out.stamp.time = at(s);
  out.robot = "Q1";
  out.source = source;
  out.world_from_body = pose;
  out.covariance = Eigen::Vector3d(0.01, 0.04, 0.01).asDiagonal();
  return out;
}

TEST(PoseSums, ComparesPosesWithTheTruthAtTheirTime) {
  PoseSums sums;
  sums.on_truth(truth(0.0, {0.0, 0.0, kPi - 0.1}));
  sums.on_truth(truth(0.1, {1.0, 0.0, -kPi + 0.1}));
  // Between the frames the truth is (0.5, 0, π).
  sums.on_pose(estimate(0.05, {0.6, 0.2, -kPi + 0.2}, models::PoseSource::kLocalizer));
  const PoseMeans means = sums.means();
  EXPECT_EQ(means.samples, 1);
  EXPECT_NEAR(*means.rmse_m, std::hypot(0.1, 0.2), 1e-9);
  EXPECT_NEAR(*means.error_max_m, std::hypot(0.1, 0.2), 1e-9);
  EXPECT_NEAR(*means.heading_rmse_rad, 0.2, 1e-9);
  EXPECT_NEAR(*means.position_nees, 0.01 / 0.01 + 0.04 / 0.04, 1e-9);
}

TEST(PoseSums, LeavesOutMotionCaptureUnknownPosesAndTimesWithoutTruth) {
  PoseSums sums;
  sums.on_truth(truth(0.0, {}));
  sums.on_pose(estimate(0.0, {9.0, 9.0, 0.0}, models::PoseSource::kMotionCapture));
  sums.on_pose(estimate(0.0, {9.0, 9.0, 0.0}, models::PoseSource::kNone));
  sums.on_pose(estimate(0.1, {9.0, 9.0, 0.0}, models::PoseSource::kLocalizer));
  sums.on_pose(estimate(-0.1, {9.0, 9.0, 0.0}, models::PoseSource::kLocalizer));
  const PoseMeans means = sums.means();
  EXPECT_EQ(means.samples, 0);
  EXPECT_EQ(means.unknown, 1);
  EXPECT_FALSE(means.rmse_m);
}

}  // namespace
}  // namespace vantage::logs
