// Tests the driver with an emulated rover in virtual time, without faults.

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/drivers/rover/rover_bench.hpp"
#include "test/support/allocation_counter.hpp"

namespace vantage::drivers {
namespace {

using models::FlightState;
using models::OperatorAction;
using test::RoverBench;

// m; documented limits of the tracking error with 3 % slip and 30 ms delay. A plan begins at full
// speed, which the wheels reach only after half a second.
constexpr double kSetOffErrorM = 0.15;
constexpr double kPlanErrorM = 0.05;
constexpr double kSetOffS = 1.5;

/// Returns a curved path of about 6 s from (1, 1) along y. Its speeds and turn rates are those of
/// the lab's motion primitives.
std::vector<models::PlanSegment> curves() {
  return {{{0.5, 0.0}, 1.5, 0.0},
          {{0.5, -0.5}, 2.0, 0.0},
          {{0.25, 0.5}, 1.5, 0.0},
          {{0.5, 0.25}, 1.0, 0.0},
          {{0.5, 0.0}, 0.25, 2.0}};
}

double error_m(const RoverBench& bench, const HeldPlan& plan) {
  const Eigen::Vector3d planned_m =
      point_at(plan, to_seconds(bench.now - plan.start_time)).position_world_m;
  return (bench.place_m() - planned_m.head<2>()).norm();
}

TEST(RoverDriver, IsStationaryUntilArmAndFollow) {
  RoverBench bench;
  bench.run(1.0);
  EXPECT_EQ(bench.driver.state(), FlightState::kIdle);
  EXPECT_TRUE(bench.driver.status(bench.now).reasons.empty());
  EXPECT_EQ(bench.plan(RoverBench::straight(0.5, 2.0)), PlanVerdict::kNotFollowing);
  EXPECT_EQ(bench.command(OperatorAction::kFollow), CommandVerdict::kRefused);
  EXPECT_EQ(bench.command(OperatorAction::kArm), CommandVerdict::kObeyed);
  bench.run(0.1);
  EXPECT_EQ(bench.driver.state(), FlightState::kHold);
  EXPECT_EQ(bench.plan(RoverBench::straight(0.5, 2.0)), PlanVerdict::kNotFollowing);
  bench.run(1.0);
  EXPECT_EQ(bench.place_m(), Eigen::Vector2d(1.0, 1.0));
}

TEST(RoverDriver, FollowsAPlanWithinTheStatedError) {
  RoverBench bench;
  ASSERT_TRUE(bench.make_ready());
  ASSERT_EQ(bench.plan(curves()), PlanVerdict::kAccepted);
  bench.run(0.4);
  ASSERT_EQ(bench.driver.state(), FlightState::kFollow);
  const HeldPlan plan = bench.driver.course().plan();
  double worst_m = 0.0;
  double set_off_m = 0.0;
  while (bench.now < plan.start_time + from_seconds(duration_s(plan))) {
    bench.step();
    const bool sets_off = bench.now < plan.start_time + from_seconds(kSetOffS);
    double& worst_now_m = sets_off ? set_off_m : worst_m;
    worst_now_m = std::max(worst_now_m, error_m(bench, plan));
    ASSERT_EQ(bench.driver.state(), FlightState::kFollow);
  }
  EXPECT_LT(set_off_m, kSetOffErrorM);
  EXPECT_LT(worst_m, kPlanErrorM);
  RecordProperty("set_off_mm", static_cast<int>(1000.0 * set_off_m));
  bench.run(1.0);
  EXPECT_TRUE(bench.is_stationary());
  EXPECT_LT(error_m(bench, plan), 0.05);
  RecordProperty("worst_mm", static_cast<int>(1000.0 * worst_m));
}

TEST(RoverDriver, ContinuesWithTheNextPlan) {
  RoverBench bench;
  ASSERT_TRUE(bench.make_ready());
  ASSERT_EQ(bench.plan(RoverBench::straight(0.5, 6.0)), PlanVerdict::kAccepted);
  const Time second = bench.now + from_seconds(0.3 + 3.0);
  bench.run(2.5);
  const HeldPlan first = bench.driver.course().plan();
  const Setpoint there = point_at(first, 3.0);
  const std::vector<models::PlanSegment> arc = {{{0.5, -0.8}, 2.0, 0.0}, {{0.5, 0.0}, 0.25, 2.0}};
  ASSERT_EQ(
      bench.plan(arc, to_seconds(second - bench.now),
                 Pose2{there.position_world_m.x(), there.position_world_m.y(), there.yaw_rad}),
      PlanVerdict::kAccepted);
  ASSERT_TRUE(bench.run_until([&] { return bench.now > second; }, 2.0));
  bench.run(0.02);
  const HeldPlan plan = bench.driver.course().plan();
  ASSERT_EQ(plan.start_time, second);
  double worst_m = 0.0;
  while (bench.now < second + from_seconds(2.2)) {
    bench.step();
    worst_m = std::max(worst_m, error_m(bench, plan));
  }
  EXPECT_LT(worst_m, kPlanErrorM);
  EXPECT_EQ(bench.driver.state(), FlightState::kFollow);
}

TEST(RoverDriver, ReturnsToAPlanThatBeginsNearby) {
  RoverBench bench;
  ASSERT_TRUE(bench.make_ready());
  ASSERT_EQ(bench.plan(RoverBench::straight(0.5, 6.0), 0.3, Pose2{1.15, 1.0, kPi / 2}),
            PlanVerdict::kAccepted);
  bench.run(5.0);
  EXPECT_EQ(bench.driver.state(), FlightState::kFollow);
  EXPECT_LT(std::abs(bench.place_m().x() - 1.15), 0.03);
}

TEST(RoverDriver, DrivesThroughWaypoints) {
  RoverBench bench;
  ASSERT_TRUE(bench.make_ready());
  const std::vector<Waypoint> places = {{{1.0, 2.0}, 0.5}, {{2.5, 2.0}, 0.5}};
  ASSERT_EQ(bench.driver.drive_through(places, bench.now), PlanVerdict::kAccepted);
  double least_m = 1e9;
  for (int i = 0; i < 1'900; ++i) {
    bench.step();
    least_m = std::min(least_m, (bench.place_m() - places[0].position_world_m).norm());
  }
  EXPECT_LT(least_m, 0.08);
  EXPECT_TRUE(bench.is_stationary());
  EXPECT_LT((bench.place_m() - places[1].position_world_m).norm(), 0.08);
  const std::vector<Waypoint> outside = {{{-1.0, 2.0}, 0.5}};
  EXPECT_EQ(bench.driver.drive_through(outside, bench.now), PlanVerdict::kOutsideFence);
}

TEST(RoverDriver, RefusesForbiddenPlans) {
  scenario::Scenario scenario = RoverBench::scenario_for();
  scenario.world.obstacles = {{{{0.8, 2.0}, {1.2, 2.4}}, 0.5}};
  RoverBench bench(scenario);
  ASSERT_TRUE(bench.make_ready());
  EXPECT_EQ(bench.plan(RoverBench::straight(0.5, 3.0)), PlanVerdict::kObstacle);
  EXPECT_EQ(bench.plan(RoverBench::straight(1.5, 0.1)), PlanVerdict::kInfeasible);
  EXPECT_EQ(bench.plan({{{0.5, 0.0}, 1.0, 0.0}}), PlanVerdict::kNoHover);
  EXPECT_EQ(bench.plan(RoverBench::straight(0.5, 1.0), 0.3, Pose2{2.0, 1.0, kPi / 2}),
            PlanVerdict::kDiscontinuous);
  EXPECT_EQ(bench.plan(RoverBench::straight(0.3, 1.0)), PlanVerdict::kAccepted);
}

TEST(RoverDriver, LandStopsAndDisarms) {
  RoverBench bench;
  ASSERT_TRUE(bench.make_ready());
  ASSERT_EQ(bench.plan(RoverBench::straight(0.5, 6.0)), PlanVerdict::kAccepted);
  bench.run(2.0);
  ASSERT_FALSE(bench.is_stationary());
  EXPECT_EQ(bench.command(OperatorAction::kLand), CommandVerdict::kObeyed);
  bench.run(0.1);
  EXPECT_EQ(bench.driver.state(), FlightState::kLand);
  EXPECT_TRUE(bench.run_until([&] { return bench.driver.state() == FlightState::kIdle; }, 0.6));
  bench.run(0.05);
  EXPECT_TRUE(bench.is_stationary());
}

TEST(RoverDriver, TicksWithoutAllocating) {
  RoverBench bench;
  ASSERT_TRUE(bench.make_ready());
  ASSERT_EQ(bench.plan(RoverBench::straight(0.5, 6.0)), PlanVerdict::kAccepted);
  bench.run(1.0);
  const test::AllocationCounter allocations;
  for (int i = 1; i <= 20; ++i) {
    (void)bench.driver.tick(bench.now + i * Duration{1'000});
  }
  EXPECT_EQ(allocations.count(), 0U);
}

TEST(RoverDriver, RefusesUnknownRobotsAndRobotsThatAreNotRovers) {
  scenario::Scenario scenario = RoverBench::scenario_for();
  const SafetyLimits limits = limits_for(scenario, "R1");
  EXPECT_THROW(RoverDriver(scenario, "R9", limits, 1), UsageError);
  scenario.robots[0].rover.reset();
  EXPECT_THROW(RoverDriver(scenario, "R1", limits, 1), UsageError);
}

// A person crosses the path of the rover without stopping. The rover stops before the person is
// closer than separation_hold_m.
TEST(RoverDriver, StopsBeforeACrossingPersonIsClose) {
  for (const double speed_mps : {0.5, 1.0, 1.5}) {
    for (const double heading_rad : {-kPi / 2, -kPi / 4, 0.0, kPi, kPi / 4}) {
      RoverBench bench;
      ASSERT_TRUE(bench.make_ready());
      ASSERT_EQ(bench.plan(RoverBench::straight(0.5, 9.0)), PlanVerdict::kAccepted);
      bench.run(2.0);
      const double hold_m = limits_for(bench.scenario, "R1").separation_hold_m;
      const Eigen::Vector2d step_m =
          0.005 * speed_mps * Eigen::Vector2d(std::cos(heading_rad), std::sin(heading_rad));
      // Rover and person would meet 0.75 m ahead of the rover after 1.5 s.
      Eigen::Vector2d person_m = bench.place_m() + Eigen::Vector2d(0.0, 0.75) - 300.0 * step_m;
      const double begins_m = (person_m - bench.place_m()).norm();
      if (begins_m < 1.2) {
        person_m -= 240.0 * step_m;  // moves the start farther away
      }
      double least_m = 1e9;
      for (int i = 0; i < 600 && !(i > 0 && bench.is_stationary()); ++i) {
        person_m += step_m;
        bench.target_m = person_m;
        bench.step();
        least_m = std::min(least_m, (bench.place_m() - person_m).norm());
      }
      EXPECT_GE(least_m, hold_m) << speed_mps << " m/s, " << heading_rad;
    }
  }
}

}  // namespace
}  // namespace vantage::drivers
