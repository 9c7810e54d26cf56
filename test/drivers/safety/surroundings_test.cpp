#include "drivers/quadrotor/safety/surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/quadrotor/safety/plan_check.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/support/random.hpp"

namespace vantage::drivers {
namespace {

SafetyLimits bench_limits() { return limits_for(test::FlightBench::scenario(), "Q1"); }

double clearance_m(const Eigen::Vector3d& p_m, const SafetyLimits& limits) {
  const Eigen::Vector2d level_m = p_m.head<2>();
  return std::min(fence_distance_m(limits.fence, level_m),
                  obstacle_distance_m(limits.fence, level_m)) -
         limits.vehicle.radius_m;
}

TEST(ClearSpot, IsClearNearAndLeavesAloneWhoIsClear) {
  const SafetyLimits limits = bench_limits();
  test::Random random(11);
  int moved = 0;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d hover_m(random.uniform(-4.0, 4.0), random.uniform(-2.2, 2.2), 1.0);
    const double before_m = clearance_m(hover_m, limits);
    const auto spot_m = clear_spot(hover_m, {}, limits);
    if (before_m >= limits.hover_clearance_m) {
      EXPECT_FALSE(spot_m.has_value());
    } else if (before_m > -0.25) {  // 0.4 m to go at most, and 0.6 looked through
      ASSERT_TRUE(spot_m.has_value()) << hover_m.transpose();
      EXPECT_GE(clearance_m(*spot_m, limits), limits.hover_clearance_m + 0.05);
      EXPECT_LE((*spot_m - hover_m).norm(), 0.6 + 1e-9);
      EXPECT_EQ(spot_m->z(), hover_m.z());
      ++moved;
    }
  }
  EXPECT_GT(moved, 500);
}

TEST(ClearSpot, DoesNotComeNearerToAnotherThanItShould) {
  const SafetyLimits limits = bench_limits();
  test::Random random(12);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d hover_m(random.uniform(-4.0, 4.0), random.uniform(-2.2, 2.2), 1.0);
    std::vector<OtherBody> others(2);
    for (OtherBody& other : others) {
      other.position_world_m =
          hover_m + Eigen::Vector3d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), 0.0);
    }
    if (const auto spot_m = clear_spot(hover_m, others, limits)) {
      for (const OtherBody& other : others) {
        const double before_m = (hover_m - other.position_world_m).norm();
        const double after_m = (*spot_m - other.position_world_m).norm();
        EXPECT_GE(after_m, std::min(before_m, limits.separation_hold_m));
      }
    }
  }
}

// Told to hold at the very edge of an obstacle, it goes a little way off, and flies on when told
// to.
TEST(FlightGuard, DoesNotHoverWhereAGustWouldMakeItTouchSomething) {
  test::FlightBench bench(1);
  bench.fly_up(6.4);
  test::Vehicle& vehicle = bench.vehicle("Q3");
  const SafetyLimits limits = limits_for(test::FlightBench::scenario(), "Q3");
  while (!(vehicle.velocity_mps.x() > 0.9 && std::abs(vehicle.position_m.x() + 0.25) < 0.02)) {
    ASSERT_LT(bench.time_s(), 20.0);
    bench.tick();
  }
  vehicle.position_m.y() = 1.07;  // the obstacle ends at 0.8, and the radius is 0.25
  bench.tick();
  bench.room().says = models::OperatorAction::kHold;
  bench.tick();
  ASSERT_EQ(vehicle.out.state, models::FlightState::kHold);
  for (const double until_s = bench.time_s() + 5.0; bench.time_s() < until_s;) {
    bench.tick();
    EXPECT_GT(clearance_m(vehicle.position_m, limits), 0.0);
  }
  EXPECT_EQ(vehicle.out.state, models::FlightState::kHold);
  EXPECT_GT(clearance_m(vehicle.position_m, limits), limits.hover_clearance_m);
  bench.room().says = models::OperatorAction::kFollow;
  for (const double until_s = bench.time_s() + 5.0; bench.time_s() < until_s;) {
    bench.tick();
  }
  EXPECT_EQ(vehicle.out.state, models::FlightState::kFollow);
}

// The cameras' pose jumps by as much as the gate lets through: nobody takes it for a flight at
// metres a second, and brakes through the room from that.
TEST(FlightGuard, IsNotCarriedAwayByASmallJumpOfThePose) {
  test::FlightBench bench(1);
  bench.fly_up(6.4);
  test::Vehicle& vehicle = bench.vehicle("Q3");
  const double lane_y_m = vehicle.position_m.y();
  vehicle.position_m.y() -= 0.2;
  for (const double until_s = bench.time_s() + 10.0; bench.time_s() < until_s;) {
    bench.tick();
    EXPECT_LT(std::abs(vehicle.position_m.y() - lane_y_m), 0.25);
  }
  EXPECT_EQ(vehicle.out.state, models::FlightState::kFollow);
}

// A late climber met who flew above it.
TEST(ClimbTaken, ByARobotAboveUpToTheGoalNowOrSoonFromEitherSide) {
  const SafetyLimits limits;
  const Eigen::Vector3d here_m(0.0, 0.0, 0.3);
  const auto is_taken = [&](double x_m, double z_m, double vx_mps, int robot = 1) {
    OtherBody body;
    body.position_world_m = {x_m, 0.0, z_m};
    body.velocity_world_mps = {vx_mps, 0.0, 0.0};
    body.robot = robot;
    return is_climb_taken(here_m, 2.0, {&body, 1}, limits);
  };
  for (const double side : {1.0, -1.0}) {
    EXPECT_TRUE(is_taken(0.5 * side, 1.0, 0.0));
    EXPECT_FALSE(is_taken(1.5 * side, 1.0, 0.0));
    EXPECT_TRUE(is_taken(1.5 * side, 1.0, -0.5 * side)) << "it comes";
    EXPECT_FALSE(is_taken(1.5 * side, 1.0, 0.5 * side)) << "it goes";
  }
  EXPECT_FALSE(is_taken(0.5, 0.2, 0.0)) << "below us";
  EXPECT_FALSE(is_taken(0.5, 2.0 + limits.separation_hold_m + 0.01, 0.0)) << "above it all";
  EXPECT_TRUE(is_taken(0.5, 2.0 + limits.separation_hold_m - 0.01, 0.0));
  EXPECT_FALSE(is_taken(0.5, 1.0, 0.0, -1)) << "no robot";
}

}  // namespace
}  // namespace vantage::drivers
