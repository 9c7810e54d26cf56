#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "drivers/safety/surroundings.hpp"
#include "test/drivers/safety/flight_bench.hpp"

// Where one comes down, and who comes near.

namespace vantage::drivers {
namespace {

SafetyLimits wide_limits() {
  SafetyLimits limits = limits_for(test::FlightBench::scenario(), "Q1");
  limits.fence.bounds = {{-10.0, -10.0}, {10.0, 10.0}};
  limits.fence.obstacles.clear();
  return limits;
}

// Somebody below, not seen for long: the nearest ring that is far enough, as far as 1.5 m away.
TEST(LandingSpot, IsTheNearestFreeOfSomePlacesWithinAMetreAndAHalf) {
  SafetyLimits limits = wide_limits();
  const Eigen::Vector3d hover_m(0.5, -0.5, 1.0);
  OtherBody below;
  below.position_world_m = {hover_m.x(), hover_m.y(), 0.0};
  below.age_s = 100.0;
  EXPECT_EQ(landing_spot(hover_m, {}, limits), hover_m);
  for (const double grown_m : {0.0, 0.2, 0.45, 0.7, 0.75}) {
    limits.other_pose_growth_max_m = grown_m;
    const double needed_m = limits.landing_clearance_m + grown_m + 0.1;
    const double ring_m = 0.25 * std::ceil(needed_m / 0.25);
    const Eigen::Vector3d spot_m = landing_spot(hover_m, {&below, 1}, limits);
    EXPECT_EQ(spot_m.z(), hover_m.z());
    EXPECT_NEAR((spot_m - hover_m).norm(), ring_m <= 1.5 ? ring_m : 0.0, 1e-9) << needed_m;
  }
}

// Robots that stand wait for their turn; what moves comes, and people are where they are.
TEST(NearSoon, CountsWhoMovesOrIsNoRobotAndWhereItWillBe) {
  const Eigen::Vector3d here_m(1.0, 2.0, 0.0);
  const double never_m = std::numeric_limits<double>::infinity();
  const auto near_m = [&](int robot, double vx_mps) {
    OtherBody body;
    body.position_world_m = {4.0, 2.0, 7.0};
    body.velocity_world_mps = {vx_mps, 0.0, 5.0};
    body.robot = robot;
    return near_soon_m(here_m, {&body, 1}, 2.0);
  };
  EXPECT_EQ(near_soon_m(here_m, {}, 2.0), never_m);
  EXPECT_EQ(near_m(1, 0.0), never_m);
  EXPECT_EQ(near_m(0, 0.09), never_m);
  EXPECT_DOUBLE_EQ(near_m(1, -0.11), 3.0 - 0.22);
  EXPECT_DOUBLE_EQ(near_m(0, 0.11), 3.0);
  EXPECT_DOUBLE_EQ(near_m(-1, 0.0), 3.0);
  EXPECT_DOUBLE_EQ(near_m(-1, -1.0), 1.0);
}

}  // namespace
}  // namespace vantage::drivers
