#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "drivers/rover/steering.hpp"
#include "drivers/rover/waypoint_path.hpp"
#include "drivers/safety/plan_check.hpp"
#include "sim/rover/rover.hpp"

namespace vantage::drivers {
namespace {

const models::VehicleLimits kLimits{1.0, 2.0, 2.0, 0.2};

Setpoint point_of(const Pose2& pose, double speed_mps, double yaw_rate_radps) {
  Setpoint out;
  out.position_world_m = {pose.x_m, pose.y_m, 0.0};
  out.yaw_rad = pose.yaw_rad;
  out.velocity_world_mps =
      speed_mps * Eigen::Vector3d(std::cos(pose.yaw_rad), std::sin(pose.yaw_rad), 0.0);
  out.yaw_rate_radps = yaw_rate_radps;
  return out;
}

TEST(Steer, EqualsTheReferenceWithoutError) {
  const Pose2 pose{1.0, -2.0, 2.5};
  const models::UnicycleControl out = steer(pose, point_of(pose, 0.6, -0.4), kLimits);
  EXPECT_NEAR(out.speed_mps, 0.6, 1e-12);
  EXPECT_NEAR(out.yaw_rate_radps, -0.4, 1e-12);
}

TEST(Steer, CorrectsLateralAndLongitudinalErrors) {
  const Pose2 pose{0.0, 0.0, 0.0};
  EXPECT_GT(steer(pose, point_of({0.0, 0.1, 0.0}, 0.5, 0.0), kLimits).yaw_rate_radps, 0.0);
  EXPECT_LT(steer(pose, point_of({0.0, -0.1, 0.0}, 0.5, 0.0), kLimits).yaw_rate_radps, 0.0);
  EXPECT_GT(steer(pose, point_of({0.1, 0.0, 0.0}, 0.5, 0.0), kLimits).speed_mps, 0.5);
  EXPECT_LT(steer(pose, point_of({-0.1, 0.0, 0.0}, 0.5, 0.0), kLimits).speed_mps, 0.5);
}

TEST(Steer, RespectsLimitsAndNeverReverses) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(-3.0, 3.0);
  for (int i = 0; i < 10'000; ++i) {
    const auto out = steer(
        {any(random), any(random), any(random)},
        point_of({any(random), any(random), any(random)}, 0.3 * std::abs(any(random)), any(random)),
        kLimits);
    ASSERT_GE(out.speed_mps, 0.0);
    ASSERT_LE(out.speed_mps, kLimits.speed_max_mps);
    ASSERT_LE(std::abs(out.yaw_rate_radps), kLimits.yaw_rate_max_radps);
  }
}

// The control law is exponentially stable along a moving reference: errors vanish within a few
// metres.
TEST(Steer, BringsAnExactUnicycleBackToACircle) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> off(-0.2, 0.2);
  for (int run = 0; run < 50; ++run) {
    Pose2 reference{0.0, 0.0, 0.3};
    Pose2 pose{off(random), off(random), 0.3 + off(random)};
    constexpr double kDtS = 0.005;
    for (int i = 0; i < 4'000; ++i) {
      const auto u = steer(pose, point_of(reference, 0.5, 0.4), kLimits);
      const auto drive = [](const Pose2& from, double v, double w) {
        const double middle_rad = from.yaw_rad + 0.5 * w * kDtS;
        return Pose2{from.x_m + v * kDtS * std::cos(middle_rad),
                     from.y_m + v * kDtS * std::sin(middle_rad),
                     wrap_to_pi(from.yaw_rad + w * kDtS)};
      };
      pose = drive(pose, u.speed_mps, u.yaw_rate_radps);
      reference = drive(reference, 0.5, 0.4);
    }
    ASSERT_LT((pose.position_m() - reference.position_m()).norm(), 1e-3) << "run " << run;
    ASSERT_LT(std::abs(wrap_to_pi(pose.yaw_rad - reference.yaw_rad)), 1e-3);
  }
}

TEST(BrakeOnCircle, KeepsTheRadiusAndStopsInTime) {
  models::UnicycleControl control{0.8, -0.4};
  for (int i = 0; i < 39; ++i) {
    control = brake_on_circle(control, 2.0, 0.01);
    ASSERT_NEAR(control.speed_mps / control.yaw_rate_radps, -2.0, 1e-9);
  }
  EXPECT_NEAR(control.speed_mps, 0.02, 1e-9);
  control = brake_on_circle(control, 2.0, 0.011);
  EXPECT_EQ(control.speed_mps, 0.0);
  EXPECT_EQ(control.yaw_rate_radps, 0.0);
  EXPECT_EQ(brake_on_circle({0.0, 1.0}, 2.0, 0.01).yaw_rate_radps, 0.0);
}

TEST(WaypointTrajectory, PassesEveryWaypointAndStopsAtTheLast) {
  const std::vector<Waypoint> places = {{{2.0, 0.0}, 0.5}, {{2.0, 0.05}, 5.0}, {{-1.0, 1.0}, 1.0}};
  const models::Trajectory way = waypoint_trajectory(places, {0.0, 0.0, 1.0}, 0.2, Time{}, kLimits);
  HeldPlan held;
  ASSERT_TRUE(hold_plan(way, held));
  SafetyLimits limits;
  limits.vehicle = kLimits;
  EXPECT_EQ(check_shape(held, limits), PlanVerdict::kAccepted);
  EXPECT_LT(
      (point_at(held, duration_s(held)).position_world_m - Eigen::Vector3d(-1.0, 1.0, 0.2)).norm(),
      1e-9);
  for (const Waypoint& place : places) {
    double least_m = 1e9;
    for (double t = 0.0; t <= duration_s(held) + 0.01; t += 0.01) {
      const Eigen::Vector2d here_m = point_at(held, t).position_world_m.head<2>();
      least_m = std::min(least_m, (here_m - place.position_world_m).norm());
    }
    EXPECT_LT(least_m, 0.005);
  }
}

TEST(WaypointTrajectory, IsEmptyAtTheGoal) {
  const std::vector<Waypoint> here = {{{1.0, 1.0}, 0.5}};
  EXPECT_TRUE(waypoint_trajectory(here, {1.0, 1.0, 0.0}, 0.2, Time{}, kLimits).segments.empty());
}

}  // namespace
}  // namespace vantage::drivers
