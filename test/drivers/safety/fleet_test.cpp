#include "drivers/quadrotor/safety/fleet.hpp"

#include <gtest/gtest.h>

#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::drivers {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

class TeammatesPlans : public testing::Test {
 protected:
  /// A hover at (x, 0) from `start_s` on, heard at `at_s`.
  bool hear(std::int64_t run, std::int64_t sequence, double start_s, double at_s,
            const std::string& robot = "Q2") {
    models::RobotPlan plan;
    plan.robot = robot;
    plan.trajectory.start_time = kStart + from_seconds(start_s);
    plan.trajectory.height_m = 1.0;
    plan.stamp = {plan.trajectory.start_time, run, sequence};
    return fleet.on_plan(plan, limits, kStart + from_seconds(at_s));
  }

  models::Scenario scenario = test::FlightBench::scenario();
  SafetyLimits limits = limits_for(scenario, "Q1");
  Fleet fleet{scenario, "Q1"};
};

TEST_F(TeammatesPlans, MustBeOfNow) {
  EXPECT_FALSE(hear(1, 0, -3600.0, 0.0)) << "of an old log";
  EXPECT_FALSE(hear(1, 1, 3600.0, 0.0)) << "it would keep every true one out for an hour";
  EXPECT_TRUE(hear(1, 2, 1.0, 0.0));
  EXPECT_FALSE(hear(1, 3, 1.0, 0.0, "Q9"));
  EXPECT_EQ(fleet.plans_refused(), 3);
}

TEST_F(TeammatesPlans, AreNewEachTime) {
  EXPECT_TRUE(hear(1, 5, 1.0, 0.0));
  EXPECT_FALSE(hear(1, 5, 1.0, 0.1));
  EXPECT_FALSE(hear(1, 4, 1.5, 0.1));
  EXPECT_FALSE(hear(1, 6, 0.5, 0.1)) << "begins before the last";
  EXPECT_TRUE(hear(1, 7, 1.0, 0.1));
}

TEST_F(TeammatesPlans, AreOfThePlannerThatHoldsTheLease) {
  EXPECT_TRUE(hear(1, 0, 1.0, 0.0));
  EXPECT_FALSE(hear(2, 0, 1.5, 0.5));
  EXPECT_TRUE(hear(2, 0, 1.0, 0.5, "Q3")) << "each teammate has its own";
  const double after_s = limits.planner_lease_s + 0.1;
  EXPECT_TRUE(hear(2, 1, after_s, after_s));
  EXPECT_FALSE(hear(1, 1, after_s, after_s));
}

}  // namespace
}  // namespace vantage::drivers
