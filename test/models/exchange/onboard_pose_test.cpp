#include "models/exchange/onboard_pose.hpp"

#include <gtest/gtest.h>

namespace vantage::models {
namespace {

const Time kStart = from_utime(1'700'000'000'000'000);

Time after(double s) { return kStart + from_seconds(s); }

PoseEstimate estimate_at(double s, const Pose2& pose) {
  PoseEstimate estimate;
  estimate.stamp.time = after(s);
  estimate.source = PoseSource::kLocalizer;
  estimate.world_from_body = pose;
  return estimate;
}

void expect_near(const Pose2& a, const Pose2& b) {
  EXPECT_NEAR(a.x_m, b.x_m, 1e-12);
  EXPECT_NEAR(a.y_m, b.y_m, 1e-12);
  EXPECT_NEAR(a.yaw_rad, b.yaw_rad, 1e-12);
}

TEST(OnboardPose, FollowsTheOdometryFromItsStart) {
  OnboardPose pose({1.0, 2.0, kPi / 2}, kStart);
  pose.move(after(0.1), {0.5, 0.0, 0.1});
  expect_near(pose.world_from_body(), Pose2{1.0, 2.0, kPi / 2} * Pose2{0.5, 0.0, 0.1});
}

// An estimate of an earlier time is moved by the odometry since then.
TEST(OnboardPose, AppliesACorrectionAtTheTimeOfTheEstimate) {
  OnboardPose pose({}, kStart);
  pose.move(after(0.1), {0.5, 0.0, 0.1});
  pose.move(after(0.2), {0.5, 0.1, -0.3});
  pose.correct(estimate_at(0.1, {3.0, 4.0, 0.5}));
  expect_near(pose.world_from_body(), Pose2{3.0, 4.0, 0.5} * Pose2{0.5, 0.1, -0.3});
}

TEST(OnboardPose, ExtrapolatesTheLastMotionForALimitedTime) {
  OnboardPose pose({}, kStart);
  pose.move(after(0.1), {0.05, 0.0, 0.02});
  expect_near(pose.at(after(0.15)), Pose2{0.05, 0.0, 0.02} * Pose2{0.025, 0.0, 0.01});
  expect_near(pose.at(after(9.0)), Pose2{0.05, 0.0, 0.02} * Pose2{0.1, 0.0, 0.04});
}

TEST(OnboardPose, IgnoresUnknownPosesAndPosesBeforeTheFirstSample) {
  OnboardPose pose({1.0, 0.0, 0.0}, kStart);
  PoseEstimate unknown = estimate_at(0.0, {9.0, 9.0, 0.0});
  unknown.source = PoseSource::kNone;
  pose.correct(unknown);
  pose.correct(estimate_at(-1.0, {9.0, 9.0, 0.0}));
  expect_near(pose.world_from_body(), {1.0, 0.0, 0.0});
}

}  // namespace
}  // namespace vantage::models
