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

TEST(Pose3, StaysAUnitRotationOverManyProducts) {
  test::Random random(4);
  Pose3 pose;
  for (int i = 0; i < 100'000; ++i) {
    pose = pose * exp_se3(random.vector<6>(-0.1, 0.1));
  }
  EXPECT_NEAR(pose.rotation.norm(), 1.0, 1e-14);
}

// Compares with the same series in long double, which is accurate at small angles without special
// cases.
TEST(ExpSe2, KeepsAllDigitsAtSmallAngles) {
  for (double angle_rad = 1e-9; angle_rad < 1.0; angle_rad *= 1.7) {
    const long double w = angle_rad;
    const long double half_sine = std::sin(0.5L * w);
    const auto sideways = static_cast<double>(2.0L * half_sine * half_sine / w);
    const auto ahead = static_cast<double>(std::sin(w) / w);
    const Pose2 pose = exp_se2({1.0, 0.0, angle_rad});
    EXPECT_NEAR(pose.y_m / sideways, 1.0, 1e-15) << angle_rad;
    EXPECT_NEAR(pose.x_m, ahead, 1e-15) << angle_rad;
  }
}

TEST(ExpSe3, InThePlaneIsExpSe2AtEveryAngle) {
  for (double angle_rad = 1e-9; angle_rad < 3.0; angle_rad *= 1.7) {
    Eigen::Matrix<double, 6, 1> twist;
    twist << 0.8, -0.4, 0.3, 0.0, 0.0, angle_rad;
    const Pose2 planar = exp_se2({0.8, -0.4, angle_rad});
    const Pose3 pose = exp_se3(twist);
    EXPECT_NEAR(pose.translation_m.x(), planar.x_m, 1e-14) << angle_rad;
    EXPECT_NEAR(pose.translation_m.y(), planar.y_m, 1e-14) << angle_rad;
    EXPECT_NEAR(pose.translation_m.z(), 0.3, 1e-15) << angle_rad;
  }
}

TEST(Flatten, GivesZeroHeadingForVerticalBody) {
  const Pose3 upright{Eigen::Vector3d(1.0, 2.0, 3.0),
                      Eigen::Quaterniond(Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitZ()) *
                                         Eigen::AngleAxisd(-0.5 * kPi, Eigen::Vector3d::UnitY()))};
  EXPECT_EQ(flatten(upright).yaw_rad, 0.0);
}

TEST(LogSe3, IsIndependentOfTheQuaternionsSign) {
  test::Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const Pose3 pose = exp_se3(random.vector<6>(-1.7, 1.7));
    Pose3 same = pose;
    same.rotation.coeffs() = -same.rotation.coeffs();
    ASSERT_TRUE(test::is_near(log_se3(same), log_se3(pose), 1e-12));
    ASSERT_LE(log_se3(same).tail<3>().norm(), kPi);
  }
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

TEST(Lift, ComposesWithFlatteningOfPlanarMotions) {
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
