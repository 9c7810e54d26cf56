#include "drivers/vehicle/steering.hpp"

#include <random>

#include <gtest/gtest.h>

#include "test/support/near.hpp"

namespace vantage::drivers {
namespace {

constexpr models::VehicleLimits kLimits{1.0, 3.0, 2.0, 0.25};

Setpoint planned_at(const Eigen::Vector3d& position_m, const Eigen::Vector3d& velocity_mps) {
  Setpoint out;
  out.position_world_m = position_m;
  out.velocity_world_mps = velocity_mps;
  out.yaw_rad = 0.5;
  return out;
}

BodyState seen_at(const Eigen::Vector3d& position_m) {
  BodyState out;
  out.world_from_body.translation_m = position_m;
  return out;
}

TEST(Steering, LeavesSetPointsWithinTheLimitsUnchanged) {
  Setpoint planned = planned_at({1.0, 2.0, 1.5}, {0.6, -0.8, 0.5});
  planned.acceleration_world_mps2 = {1.0, 2.0, 0.0};
  planned.yaw_rate_radps = -3.0;
  const Setpoint steered = steer(planned, seen_at({1.2, 2.1, 1.4}), kLimits);
  EXPECT_TRUE(test::is_near(steered.position_world_m, planned.position_world_m, 1e-12));
  EXPECT_TRUE(test::is_near(steered.velocity_world_mps, planned.velocity_world_mps, 1e-12));
  EXPECT_EQ(steered.acceleration_world_mps2, planned.acceleration_world_mps2);
  EXPECT_EQ(steered.yaw_rad, 0.5);
  EXPECT_EQ(steered.yaw_rate_radps, -3.0);
}

// The speed limits apply in every direction. The position set-point stays within kReachM of the
// vehicle.
TEST(Steering, LimitsSpeedsAndDistance) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> any(-3.0, 3.0);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d here_m(any(rng), any(rng), any(rng));
    Setpoint planned = planned_at({any(rng), any(rng), any(rng)}, {any(rng), any(rng), any(rng)});
    planned.yaw_rate_radps = 3.0 * any(rng);
    const Setpoint steered = steer(planned, seen_at(here_m), kLimits);
    EXPECT_LE(steered.velocity_world_mps.head<2>().norm(), kLimits.speed_max_mps + 1e-9);
    EXPECT_LE(std::abs(steered.velocity_world_mps.z()), 0.7);
    EXPECT_LE(std::abs(steered.yaw_rate_radps), kLimits.yaw_rate_max_radps);
    const Eigen::Vector3d away_m = steered.position_world_m - here_m;
    EXPECT_LE(away_m.head<2>().norm(), kReachM + 1e-9);
    EXPECT_LE(std::abs(away_m.z()), kReachM + 1e-9);
    // The position set-point must lie in the direction of the original set-point.
    const Eigen::Vector3d wanted_m = planned.position_world_m - here_m;
    EXPECT_NEAR(away_m.x() * wanted_m.y(), away_m.y() * wanted_m.x(), 1e-9);
    EXPECT_GE(away_m.head<2>().dot(wanted_m.head<2>()), 0.0);
  }
}

TEST(Steering, KeepsThePositionWhileTheBodyIsUnseen) {
  const Setpoint planned = planned_at({9.0, -9.0, 2.0}, {0.0, 0.0, 0.0});
  EXPECT_EQ(steer(planned, std::nullopt, kLimits).position_world_m, planned.position_world_m);
}

// A mirrored input gives the mirrored output.
TEST(Steering, IsInvariantUnderMirroring) {
  const Eigen::Vector3d mirror(1.0, -1.0, 1.0);
  const Setpoint planned = planned_at({2.0, 1.0, 1.0}, {1.0, 2.0, 0.1});
  Setpoint mirrored = planned_at(planned.position_world_m.cwiseProduct(mirror),
                                 planned.velocity_world_mps.cwiseProduct(mirror));
  const Setpoint a = steer(planned, seen_at({0.5, 0.25, 1.0}), kLimits);
  const Setpoint b = steer(mirrored, seen_at({0.5, -0.25, 1.0}), kLimits);
  EXPECT_TRUE(test::is_near(a.position_world_m.cwiseProduct(mirror), b.position_world_m, 1e-12));
  EXPECT_TRUE(
      test::is_near(a.velocity_world_mps.cwiseProduct(mirror), b.velocity_world_mps, 1e-12));
}

}  // namespace
}  // namespace vantage::drivers
