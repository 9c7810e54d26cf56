#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/safety/plan_check.hpp"
#include "models/plan/plan.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/drivers/safety/held.hpp"

// Tests of the plan check against bodies without a plan, and of its cost with many teammates.

namespace vantage::drivers {
namespace {

using test::held;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

SafetyLimits limits() { return limits_for(test::FlightBench::scenario(), "Q1"); }

/// Returns a path from (−2, −1.3) along x: 3 s at 1 m/s and a stop.
HeldPlan lane() {
  models::Trajectory way;
  way.start_time = kStart;
  way.start = {-2.0, -1.3, 0.0};
  way.height_m = 1.0;
  way.segments = {{{1.0, 0.0}, 3.0, 0.0}, models::brake(1.0, 2.0).front()};
  return held(way);
}

TEST(CheckPath, AvoidsPredictedBodyPositions) {
  struct Case {
    const char* what;
    Eigen::Vector3d at_m;
    Eigen::Vector3d velocity_mps;
    PlanVerdict verdict;
  };
  const std::vector<Case> cases = {
      {"stands in the way", {0.0, -1.3, 1.0}, {0, 0, 0}, PlanVerdict::kTeammate},
      {"taller than we fly", {0.0, -1.3, 1.8}, {0, 0, 0}, PlanVerdict::kTeammate},
      {"on the floor below", {0.0, -1.3, 0.2}, {0, 0, 0}, PlanVerdict::kAccepted},
      {"drives below", {-2.0, -1.3, 0.2}, {1, 0, 0}, PlanVerdict::kAccepted},
      {"crosses in time", {0.0, 0.7, 1.0}, {0, -1, 0}, PlanVerdict::kTeammate},
      {"has gone before", {0.0, -1.3, 1.0}, {0, 1, 0}, PlanVerdict::kAccepted},
      {"comes head-on", {1.5, -1.3, 1.0}, {-1, 0, 0}, PlanVerdict::kTeammate},
      {"goes ahead as fast", {-1.0, -1.3, 1.0}, {1, 0, 0}, PlanVerdict::kAccepted},
      {"comes later than it is carried on", {1.25, 4.2, 1.0}, {0, -1.2, 0}, PlanVerdict::kAccepted},
  };
  const SafetyLimits lim = limits();
  for (const Case& each : cases) {
    OtherCourse other;
    other.position_world_m = each.at_m;
    other.velocity_world_mps = each.velocity_mps;
    other.prediction_s = lim.other_prediction_s;
    other.reaches_ground = true;
    EXPECT_EQ(check_path(lane(), kStart, lim, {&other, 1}), each.verdict) << each.what;
  }
}

// The check uses separate time steps for each teammate, so distant ones cost almost nothing.
TEST(CheckPath, NeedsFewStepsForNinetyNineTeammates) {
  SafetyLimits lim = limits();
  lim.fence.bounds = {{-400.0, -400.0}, {400.0, 400.0}};
  models::Trajectory beside;
  beside.start_time = kStart;
  beside.height_m = 1.0;
  beside.segments = {{{1.0, 0.0}, 59.0, 0.0}, models::brake(1.0, 2.0).front()};
  const HeldPlan own = held(beside);
  std::vector<HeldPlan> plans;
  for (int i = 1; i <= 99; ++i) {
    beside.start = {0.0, i * (lim.plan_separation_m + 5e-4), 0.0};
    plans.push_back(held(beside));
  }
  std::vector<OtherCourse> others;
  for (const HeldPlan& plan : plans) {
    others.push_back({&plan, Eigen::Vector3d::Zero()});
  }
  int steps = 0;
  std::vector<OtherCourse> far(others.begin() + 1, others.end());
  EXPECT_EQ(check_path(own, kStart, lim, far, &steps), PlanVerdict::kAccepted);
  EXPECT_LT(steps, 3'000);
  // Another vehicle stays half a millimetre beyond the required separation for a minute. An exact
  // check would need 60 000 steps; the check stops at its maximum number of steps.
  EXPECT_EQ(check_path(own, kStart, lim, others, &steps), PlanVerdict::kTooCostly);
  EXPECT_LE(steps, kPathStepsMax);
}

// At both sides of each segment end, a plan of 64 segments has the same states as point_at().
TEST(PlanWalk, AgreesWithPointAt) {
  models::Trajectory way;
  way.start_time = kStart;
  way.start = {0.5, -0.25, 1.0};
  way.height_m = 1.2;
  for (std::size_t i = 0; i + 1 < HeldPlan::kSegmentsMax; ++i) {
    way.segments.push_back({{0.5, i % 3 == 0 ? 1.0 : -0.7}, i % 5 == 0 ? 0.0 : 0.1, 0.0});
  }
  way.segments.push_back(models::brake(0.5, 2.0).front());
  const HeldPlan plan = held(way);
  PlanWalk walk(plan);
  for (int i = -20; i < 800; ++i) {
    const Setpoint a = walk.at(0.01 * i);
    const Setpoint b = point_at(plan, 0.01 * i);
    EXPECT_LT((a.position_world_m - b.position_world_m).norm(), 1e-9) << i;
    EXPECT_NEAR(a.yaw_rad, b.yaw_rad, 1e-9) << i;
    if (i > 0) {
      EXPECT_LT((a.velocity_world_mps - b.velocity_world_mps).norm(), 1e-9) << i;
    }
  }
}

}  // namespace
}  // namespace vantage::drivers
