#include "core/pose.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "test/support/near.hpp"
#include "test/support/random.hpp"

namespace vantage {
namespace {

TEST(Pose2, KeepsYawInTheHalfOpenInterval) {
  test::Random random(3);
  Pose2 pose;
  for (int i = 0; i < 10'000; ++i) {
    pose = pose * random.pose2(1.0);
    ASSERT_GT(pose.yaw_rad, -kPi);
    ASSERT_LE(pose.yaw_rad, kPi);
  }
}

TEST(Pose2, HalfTurnIsItsOwnInverse) {
  const Pose2 half_turn{0.0, 0.0, kPi};
  EXPECT_EQ(inverse(half_turn).yaw_rad, kPi);
}

TEST(Pose2, QuarterTurnMapsForwardToLeft) {
  const Pose2 world_from_body{1.0, 2.0, kPi / 2};
  EXPECT_TRUE(
      test::is_near(world_from_body * Eigen::Vector2d(3.0, 0.0), Eigen::Vector2d(1.0, 5.0), 1e-15));
}

TEST(Pose3, RotationStaysAUnitQuaternionOverManyProducts) {
  test::Random random(4);
  Pose3 pose;
  for (int i = 0; i < 100'000; ++i) {
    pose = pose * random.pose3(0.1);
  }
  EXPECT_NEAR(pose.rotation.norm(), 1.0, 1e-14);
}

TEST(Flatten, GivesZeroHeadingForVerticalBody) {
  const Pose3 upright{Eigen::Vector3d(1.0, 2.0, 3.0),
                      Eigen::Quaterniond(Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitZ()) *
                                         Eigen::AngleAxisd(-0.5 * kPi, Eigen::Vector3d::UnitY()))};
  EXPECT_EQ(flatten(upright).yaw_rad, 0.0);
}

TEST(Flatten, InvertsLift) {
  test::Random random(6);
  for (int i = 0; i < 1000; ++i) {
    const Pose2 pose = random.pose2(10.0);
    const Pose3 lifted = lift(pose, 1.5);
    ASSERT_EQ(lifted.translation_m.z(), 1.5);
    const Pose2 back = flatten(lifted);
    ASSERT_EQ(back.position_m(), pose.position_m());
    ASSERT_NEAR(wrap_to_pi(back.yaw_rad - pose.yaw_rad), 0.0, 1e-12);
  }
}

TEST(Flatten, KeepsTheHeadingOfABodyThatRollsAndPitches) {
  const Eigen::Quaterniond tilted = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitX());
  EXPECT_NEAR(flatten({Eigen::Vector3d::Zero(), tilted}).yaw_rad, 0.7, 1e-12);
}

TEST(Lift, PreservesProductsOfPlanarPoses) {
  test::Random random(8);
  for (int i = 0; i < 1000; ++i) {
    const Pose2 a = random.pose2(10.0);
    const Pose2 b = random.pose2(10.0);
    const Pose2 flat = flatten(lift(a, 0.5) * lift(b, 0.0));
    ASSERT_TRUE(test::is_near(flat.position_m(), (a * b).position_m(), 1e-12));
    ASSERT_NEAR(wrap_to_pi(flat.yaw_rad - (a * b).yaw_rad), 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace vantage
