#include "tools/ros2/incoming.hpp"

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "test/tools/ros2/ros2_messages.hpp"

namespace vantage::tools::ros2 {
namespace {

using scenario::Ros2PoseType;

constexpr Time kTime = from_utime(1'700'000'000'250'000);
const Pose3 kPose{{1.0, 2.0, 3.0}, Quaternion(0.5, -0.5, 0.5, 0.5)};

void expect_pose(const StampedPose& pose) {
  EXPECT_EQ(pose.stamp, kTime);
  EXPECT_EQ(pose.frame, "world");
  EXPECT_EQ(pose.frame_from_body.translation_m, kPose.translation_m);
  EXPECT_TRUE(pose.frame_from_body.rotation.isApprox(kPose.rotation, 1e-12));
}

TEST(ReadPoses, ReadsEachType) {
  const std::string pose = test::pose_message(kTime, "world", kPose);
  const auto stamped = read_poses(Ros2PoseType::kPose, test::bytes_of(pose));
  ASSERT_TRUE(stamped && stamped->size() == 1);
  expect_pose(stamped->front());
  const std::string tree =
      test::transform_message(kTime, "world", {{"Q1", kPose}, {"camera", kPose}});
  const auto transforms = read_poses(Ros2PoseType::kTransforms, test::bytes_of(tree));
  ASSERT_TRUE(transforms && transforms->size() == 2);
  expect_pose(transforms->back());
  EXPECT_EQ(transforms->back().child, "camera");
  logs::Cdr odometry;
  test::add_header(odometry, kTime, "world");
  odometry.text("base_link");
  test::add_pose(odometry, kPose);
  const auto with_child = read_poses(Ros2PoseType::kOdometry, test::bytes_of(odometry.bytes()));
  ASSERT_TRUE(with_child && with_child->size() == 1);
  expect_pose(with_child->front());
  EXPECT_EQ(with_child->front().child, "base_link");
}

TEST(ReadPoses, MarksImpossibleTransformsOnly) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Pose3 lost{{kNan, kNan, kNan}, Quaternion(0.0, 0.0, 0.0, 0.0)};
  const std::string tree =
      test::transform_message(kTime, "world", {{"Q1", kPose}, {"HAT", lost}, {"Q2", kPose}});
  const auto poses = read_poses(Ros2PoseType::kTransforms, test::bytes_of(tree));
  ASSERT_TRUE(poses && poses->size() == 3);
  EXPECT_TRUE(poses->at(0).is_possible);
  EXPECT_FALSE(poses->at(1).is_possible);
  EXPECT_TRUE(poses->at(2).is_possible);
  expect_pose(poses->at(2));
}

TEST(ReadPoses, RefusesEachTruncatedMessage) {
  const std::string whole = test::transform_message(kTime, "world", {{"Q1", kPose}, {"Q2", kPose}});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(read_poses(Ros2PoseType::kTransforms, test::bytes_of(whole.substr(0, size))))
        << size;
  }
}

TEST(ReadPoses, RefusesImpossiblePoses) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Pose3 impossible[] = {{{kNan, 0.0, 0.0}, Quaternion::Identity()},
                              {{0.0, 1e9, 0.0}, Quaternion::Identity()},
                              {{0.0, 0.0, 0.0}, Quaternion(0.0, 0.0, 0.0, 0.0)},
                              {{0.0, 0.0, 0.0}, Quaternion(2.0, 0.0, 0.0, 0.0)},
                              {{0.0, 0.0, 0.0}, Quaternion(kNan, 0.0, 0.0, 0.0)}};
  for (const Pose3& pose : impossible) {
    const std::string message = test::pose_message(kTime, "world", pose);
    EXPECT_FALSE(read_poses(Ros2PoseType::kPose, test::bytes_of(message)));
  }
}

TEST(ReadDetections, UsesTheHypothesisWithTheHighestScore) {
  const std::string message = test::detections_message(
      kTime, "Q1", {{"4", "rover", {1.0, 2.0, 0.5}, 0.04}, {"", "R2", {3.0, 4.0, 0.0}, 0.0}});
  const auto seen = read_detections(test::bytes_of(message));
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->stamp, kTime);
  EXPECT_EQ(seen->frame, "Q1");
  ASSERT_EQ(seen->objects.size(), 2U);
  EXPECT_EQ(seen->objects[0].id, "4");
  EXPECT_EQ(seen->objects[0].class_id, "rover");
  EXPECT_EQ(seen->objects[0].position_m, Eigen::Vector3d(1.0, 2.0, 0.5));
  EXPECT_EQ(seen->objects[0].covariance_m2, (0.04 * Eigen::Matrix3d::Identity()).eval());
  EXPECT_EQ(seen->objects[1].class_id, "R2");
  EXPECT_TRUE(seen->objects[1].covariance_m2.isZero(0.0));
}

TEST(ReadDetections, RefusesTruncatedAndImpossibleMessages) {
  const std::string whole =
      test::detections_message(kTime, "Q1", {{"4", "rover", {1.0, 2.0, 0.5}, 0.04}});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(read_detections(test::bytes_of(whole.substr(0, size)))) << size;
  }
  for (const double variance_m2 : {-1.0, std::numeric_limits<double>::infinity()}) {
    const std::string bad =
        test::detections_message(kTime, "Q1", {{"4", "", {1.0, 2.0, 0.5}, variance_m2}});
    EXPECT_FALSE(read_detections(test::bytes_of(bad))) << variance_m2;
  }
}

}  // namespace
}  // namespace vantage::tools::ros2
