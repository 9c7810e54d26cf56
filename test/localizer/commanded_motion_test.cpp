#include "localizer/commanded_motion.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/pose.hpp"
#include "test/support/allocation_counter.hpp"

namespace vantage::localizer {
namespace {

Time at(double s) { return from_utime(1'000'000'000'000) + from_seconds(s); }

TEST(CommandedMotion, IsZeroUntilTheDelayHasPassed) {
  CommandedMotion motion({.delay_s = 0.2});
  static_cast<void>(motion.advance_to(at(0.0)));
  motion.command(at(0.0), 1.0, 0.0);
  EXPECT_EQ(motion.advance_to(at(0.2)), Eigen::Vector3d::Zero());
  EXPECT_NEAR(motion.advance_to(at(0.5)).x(), 0.3, 1e-12);
}

TEST(CommandedMotion, ApproachesCommandExponentially) {
  CommandedMotion motion({.delay_s = 0.1, .lag_s = 0.25, .speed_scale = 1.1});
  static_cast<void>(motion.advance_to(at(0.0)));
  motion.command(at(0.0), 0.5, 0.0);
  const double driven_s = 0.9;
  const double expected_m = 1.1 * 0.5 * (driven_s - 0.25 * (1.0 - std::exp(-driven_s / 0.25)));
  EXPECT_NEAR(motion.advance_to(at(1.0)).x(), expected_m, 1e-12);
}

TEST(CommandedMotion, TurnsByScaleAndBiasOnlyWhileDriving) {
  CommandedMotion motion({.turn_scale = 0.96, .turn_bias_radps = -0.01});
  static_cast<void>(motion.advance_to(at(0.0)));
  EXPECT_EQ(motion.advance_to(at(1.0)).z(), 0.0);
  motion.command(at(1.0), 0.0, 0.5);
  EXPECT_NEAR(motion.advance_to(at(2.0)).z(), 0.96 * 0.5 - 0.01, 1e-12);
}

TEST(CommandedMotion, GivesTheSameMotionInSmallerSteps) {
  const scenario::DriveSpec drive{0.13, 0.1, 1.02, 0.97, -0.002};
  const auto drive_in_steps = [&](int steps) {
    CommandedMotion motion(drive);
    static_cast<void>(motion.advance_to(at(0.0)));
    motion.command(at(0.0), 0.2, 0.0);
    motion.command(at(0.4), 0.2, 0.3);
    Pose2 pose;
    for (int i = 1; i <= steps; ++i) {
      const Eigen::Vector3d step = motion.advance_to(at(1.0 * i / steps));
      pose = pose * Pose2{step.x(), step.y(), step.z()};
    }
    return pose;
  };
  const Pose2 coarse = drive_in_steps(10);
  const Pose2 fine = drive_in_steps(200);
  EXPECT_NEAR(coarse.yaw_rad, fine.yaw_rad, 1e-9);
  EXPECT_NEAR((coarse.position_m() - fine.position_m()).norm(), 0.0, 2e-4);
}

TEST(CommandedMotion, RefusesCommandOlderThanTheNewest) {
  CommandedMotion motion({});
  EXPECT_TRUE(motion.command(at(1.0), 0.1, 0.0));
  EXPECT_FALSE(motion.command(at(0.5), 9.0, 0.0));
}

TEST(CommandedMotion, AllocatesNothing) {
  CommandedMotion motion({.delay_s = 0.2, .lag_s = 0.1});
  const test::AllocationCounter allocations;
  for (int i = 0; i < 1000; ++i) {
    motion.command(at(0.01 * i), 0.1, 0.2);
    static_cast<void>(motion.advance_to(at(0.01 * i)));
  }
  EXPECT_EQ(allocations.count(), 0U);
}

}  // namespace
}  // namespace vantage::localizer
