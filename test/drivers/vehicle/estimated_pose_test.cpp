#include "drivers/vehicle/estimated_pose.hpp"

#include <gtest/gtest.h>

namespace vantage::drivers {
namespace {

const Time kStart = from_utime(1'700'000'000'000'000);

Time after(double s) { return kStart + from_seconds(s); }

models::MocapFrame frame_at(double s, bool occluded) {
  models::MocapFrame frame;
  frame.stamp.time = after(s);
  frame.bodies = {{"R2", lift(Pose2{9.0, 9.0, 0.0}, 0.2)}, {"R1", {}, occluded}};
  return frame;
}

models::PoseEstimate estimate_at(double s, models::PoseSource source) {
  models::PoseEstimate estimate;
  estimate.stamp.time = after(s);
  estimate.robot = "R1";
  estimate.source = source;
  estimate.world_from_body = {1.0, 2.0, 0.5};
  estimate.covariance = Eigen::Vector3d(0.01, 0.04, 0.01).asDiagonal();
  return estimate;
}

models::OdometryReport moved(double s, const Eigen::Vector3d& motion) {
  models::OdometryReport odometry;
  odometry.stamp.time = after(s);
  odometry.robot = "R1";
  odometry.interval = Duration{100'000};
  odometry.motion_body = motion;
  return odometry;
}

TEST(EstimatedPose, ReplacesThePoseInAFrameThatDoesNotShowTheVehicle) {
  EstimatedPose pose("R1", {}, 0.2, kStart);
  pose.on_odometry(moved(0.1, {0.1, 0.0, 0.0}));
  pose.on_pose(estimate_at(0.1, models::PoseSource::kLocalizer));
  pose.on_odometry(moved(0.2, {0.1, 0.0, 0.0}));
  const auto filled = pose.fill(frame_at(0.2, true));
  ASSERT_TRUE(filled);
  EXPECT_NEAR(filled->sigma_m, 0.2, 1e-9);  // √0.04
  const models::MocapBody& body = *filled->frame.find("R1");
  EXPECT_FALSE(body.occluded);
  const Pose2 expected = Pose2{1.0, 2.0, 0.5} * Pose2{0.1, 0.0, 0.0};
  EXPECT_NEAR(body.world_from_body.translation_m.x(), expected.x_m, 1e-9);
  EXPECT_NEAR(body.world_from_body.translation_m.y(), expected.y_m, 1e-9);
  EXPECT_NEAR(body.world_from_body.translation_m.z(), 0.2, 1e-9);
  EXPECT_NEAR(filled->frame.find("R2")->world_from_body.translation_m.x(), 9.0, 1e-9);
}

TEST(EstimatedPose, LeavesFramesUnchangedThatShowTheVehicle) {
  EstimatedPose pose("R1", {}, 0.2, kStart);
  pose.on_pose(estimate_at(0.0, models::PoseSource::kLocalizer));
  EXPECT_FALSE(pose.fill(frame_at(0.0, false)));
}

TEST(EstimatedPose, IsUnknownWithoutARecentPose) {
  EstimatedPose pose("R1", {}, 0.2, kStart);
  EXPECT_FALSE(pose.fill(frame_at(0.0, true)));
  pose.on_pose(estimate_at(0.0, models::PoseSource::kNone));
  EXPECT_FALSE(pose.fill(frame_at(0.0, true)));
  pose.on_pose(estimate_at(0.0, models::PoseSource::kLocalizer));
  EXPECT_TRUE(pose.fill(frame_at(0.4, true)));
  EXPECT_FALSE(pose.fill(frame_at(0.41, true)));
}

}  // namespace
}  // namespace vantage::drivers
