#include <cmath>

#include <gtest/gtest.h>

#include "models/motion/unicycle.hpp"
#include "test/support/near.hpp"
#include "test/support/random.hpp"

namespace vantage::models {
namespace {

Eigen::Vector3d as_vector(const Pose2& pose) { return {pose.x_m, pose.y_m, pose.yaw_rad}; }

// Integrates ẋ = ν cos θ, ẏ = ν sin θ, θ̇ = ω with fourth-order Runge–Kutta in many steps.
Eigen::Vector3d integrated(Eigen::Vector3d x, const UnicycleControl& u, double duration_s) {
  constexpr int kSteps = 200;
  const double h = duration_s / kSteps;
  const auto rate = [&](const Eigen::Vector3d& at) {
    return Eigen::Vector3d(u.speed_mps * std::cos(at.z()), u.speed_mps * std::sin(at.z()),
                           u.yaw_rate_radps);
  };
  for (int i = 0; i < kSteps; ++i) {
    const Eigen::Vector3d k1 = rate(x);
    const Eigen::Vector3d k2 = rate(x + 0.5 * h * k1);
    const Eigen::Vector3d k3 = rate(x + 0.5 * h * k2);
    const Eigen::Vector3d k4 = rate(x + h * k3);
    x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return x;
}

TEST(StepUnicycle, SolvesTheDifferentialEquation) {
  test::Random random(11);
  for (int i = 0; i < 1000; ++i) {
    const Pose2 start = random.pose2(10.0);
    const UnicycleControl control{random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0)};
    const Eigen::Vector3d expected = integrated(as_vector(start), control, 0.5);
    const Pose2 reached = step_unicycle(start, control, 0.5);
    ASSERT_TRUE(test::is_near(reached.position_m(), expected.head<2>(), 1e-10));
    ASSERT_NEAR(wrap_to_pi(reached.yaw_rad - expected.z()), 0.0, 1e-12);
  }
}

TEST(StepUnicycle, SolvesTheEquationAtSmallAndLargeYawRates) {
  test::Random random(12);
  for (const double yaw_rate_radps : {0.0, 1e-12, 1e-5, 2e-4, -1e-3, 1.0, -3.0, 20.0}) {
    const Pose2 start = random.pose2(10.0);
    const UnicycleControl control{2.0, yaw_rate_radps};
    const Eigen::Vector3d expected = integrated(as_vector(start), control, 0.5);
    const Pose2 reached = step_unicycle(start, control, 0.5);
    EXPECT_TRUE(test::is_near(reached.position_m(), expected.head<2>(), 1e-8));
    EXPECT_NEAR(wrap_to_pi(reached.yaw_rad - expected.z()), 0.0, 1e-12);
  }
}

TEST(StepUnicycle, TwoHalfStepsEqualOneStep) {
  test::Random random(13);
  for (int i = 0; i < 1000; ++i) {
    const Pose2 start = random.pose2(10.0);
    const UnicycleControl control{random.uniform(-3.0, 3.0), random.uniform(-6.0, 6.0)};
    const Pose2 whole = step_unicycle(start, control, 1.0);
    const Pose2 halves = step_unicycle(step_unicycle(start, control, 0.4), control, 0.6);
    ASSERT_TRUE(test::is_near(halves.position_m(), whole.position_m(), 1e-12));
    ASSERT_NEAR(wrap_to_pi(halves.yaw_rad - whole.yaw_rad), 0.0, 1e-12);
  }
}

TEST(StepUnicycle, ReturnsToTheStartAfterAFullCircle) {
  const Pose2 start{1.0, -2.0, 0.3};
  const Pose2 reached = step_unicycle(start, {3.0, 1.0}, 2.0 * kPi);
  EXPECT_TRUE(test::is_near(as_vector(reached), as_vector(start), 1e-14));
}

TEST(StepUnicycle, TurnsOnTheSpot) {
  const Pose2 reached = step_unicycle({1.0, 2.0, 3.0}, {0.0, 1.0}, 0.5);
  EXPECT_EQ(reached.position_m(), Eigen::Vector2d(1.0, 2.0));
  EXPECT_NEAR(reached.yaw_rad, wrap_to_pi(3.5), 1e-15);
}

TEST(StandardPrimitives, AreTwoSpeedsByFiveYawRates) {
  const std::vector<UnicycleControl> expected = {{1, 0}, {1, 1}, {1, -1}, {1, 3}, {1, -3},
                                                 {3, 0}, {3, 1}, {3, -1}, {3, 3}, {3, -3}};
  EXPECT_EQ(standard_primitives(), expected);
}

TEST(LabPrimitives, AreTheSlowStandardPrimitives) {
  const std::vector<UnicycleControl> standard = standard_primitives();
  EXPECT_EQ(lab_primitives(), std::vector(standard.begin(), standard.begin() + 5));
}

}  // namespace
}  // namespace vantage::models
