#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "drivers/safety/plan_check.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/drivers/safety/held.hpp"
#include "test/support/random.hpp"

// Tests position, velocity and duration of a held plan. Braking, distance checks and set-points use
// only these values.

namespace vantage::drivers {
namespace {

using test::held;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

/// Returns a random trajectory: forwards and backwards, straight, in arcs and on the spot. It has
/// stops, and some stops end before their segment does.
models::Trajectory random_way(test::Random& random) {
  models::Trajectory way;
  way.start_time = kStart;
  way.start = random.pose2(2.0);
  way.height_m = random.uniform(0.5, 2.0);
  for (int i = random.integer(1, 6); i > 0; --i) {
    const int kind = random.integer(0, 2);
    const double rate_radps = kind == 0 ? random.uniform(-3.0, 3.0) : 0.0;
    const double brake_mps2 = kind == 1 ? random.uniform(0.5, 3.0) : 0.0;
    way.segments.push_back(
        {{random.uniform(-2.0, 2.0), rate_radps}, random.uniform(0.2, 1.5), brake_mps2});
  }
  return way;
}

// Velocity and yaw rate equal the difference quotients of position and yaw, in every kind of
// segment.
TEST(PointAt, VelocityIsTheDerivativeOfPosition) {
  constexpr double kHalfS = 1e-5;
  test::Random random(41);
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    const HeldPlan plan = held(random_way(random));
    double begin_s = 0.0;
    for (std::size_t k = 0; k < plan.count; ++k) {
      const double lasts_s = plan.segments[k].duration_s;
      const double t_s = begin_s + random.uniform(0.01, 0.99) * lasts_s;
      begin_s += lasts_s;
      const Setpoint before = point_at(plan, t_s - kHalfS);
      const Setpoint here = point_at(plan, t_s);
      const Setpoint later = point_at(plan, t_s + kHalfS);
      const Eigen::Vector3d moved_mps =
          (later.position_world_m - before.position_world_m) / (2.0 * kHalfS);
      EXPECT_LT((here.velocity_world_mps - moved_mps).norm(), 1e-4) << k;
      const double turned_radps = wrap_to_pi(later.yaw_rad - before.yaw_rad) / (2.0 * kHalfS);
      EXPECT_NEAR(here.yaw_rate_radps, turned_radps, 1e-6) << k;
      EXPECT_TRUE(here.yaw_rad > -kPi && here.yaw_rad <= kPi) << here.yaw_rad;
    }
  }
}

// A stop from speed v with deceleration a has the length v²/2a and the duration v/a. For the rest
// of its segment the vehicle is stationary.
TEST(PointAt, BrakesAtTheStatedDeceleration) {
  for (const double speed_mps : {0.6, 1.0, 1.7}) {
    for (const double brake_mps2 : {0.5, 1.0, 2.5}) {
      const double stop_s = speed_mps / brake_mps2;
      for (const double sense : {1.0, -1.0}) {
        HeldPlan plan;
        plan.start.yaw_rad = 2.0;
        plan.count = 1;
        plan.segments[0] = {{sense * speed_mps, 0.0}, 3.0 * stop_s, brake_mps2};
        const Eigen::Vector3d ahead(std::cos(2.0), std::sin(2.0), 0.0);
        for (int k = 0; k <= 40; ++k) {
          const double t_s = 0.1 * k * stop_s;
          const double left_mps = std::max(0.0, speed_mps - brake_mps2 * t_s);
          const double distance_m =
              0.5 * (speed_mps * speed_mps - left_mps * left_mps) / brake_mps2;  // v² = v0² − 2as
          const Setpoint here = point_at(plan, t_s);
          EXPECT_LT((here.velocity_world_mps - sense * left_mps * ahead).norm(), 1e-12) << t_s;
          EXPECT_LT((here.position_world_m - sense * distance_m * ahead).norm(), 1e-12) << t_s;
          EXPECT_EQ(here.yaw_rad, 2.0);
          EXPECT_EQ(here.yaw_rate_radps, 0.0);
        }
      }
    }
  }
}

// After a plan, the vehicle hovers at its end, even if the plan drives and turns until its last
// instant.
TEST(PointAt, IsStationaryBeforeStartAndAfterEnd) {
  HeldPlan plan;
  plan.start = {1.0, -0.5, 3.0};
  plan.height_m = 1.3;
  for (const double speed_mps : {0.8, -0.8}) {
    for (const double rate_radps : {0.0, 1.5, -1.5}) {
      plan.count = 2;
      plan.segments[0] = {{speed_mps, -rate_radps}, 0.5, 0.0};
      plan.segments[1] = {{speed_mps, rate_radps}, 0.75, 0.0};
      const Setpoint start = point_at(plan, 0.0);
      for (const double t_s : {-1e-6, -0.7, -100.0}) {
        const Setpoint here = point_at(plan, t_s);
        EXPECT_EQ(here.position_world_m, Eigen::Vector3d(1.0, -0.5, 1.3));
        EXPECT_EQ(here.position_world_m, start.position_world_m);
        EXPECT_EQ(here.yaw_rad, 3.0);
        EXPECT_EQ(here.velocity_world_mps.norm(), 0.0);
        EXPECT_EQ(here.yaw_rate_radps, 0.0);
      }
      const Setpoint last = point_at(plan, 1.25 - 1e-9);
      EXPECT_NEAR(last.velocity_world_mps.norm(), 0.8, 1e-12);
      for (const double t_s : {1.25, 1.25 + 1e-6, 2.0, 100.0}) {
        const Setpoint here = point_at(plan, t_s);
        EXPECT_LT((here.position_world_m - last.position_world_m).norm(), 1e-8) << t_s;
        EXPECT_NEAR(wrap_to_pi(here.yaw_rad - last.yaw_rad), 0.0, 1e-8);
        EXPECT_EQ(here.velocity_world_mps.norm(), 0.0);
        EXPECT_EQ(here.yaw_rate_radps, 0.0);
      }
    }
  }
}

// Treating a slow turn as straight causes an error of at most 2 mm after 60 s at 1 m/s. The exact
// chord is v t sinc(ω t / 2), in the direction of the mean heading.
TEST(PointAt, ComputesSlowTurnsToTwoMillimetres) {
  HeldPlan plan;
  plan.count = 1;
  for (const double rate_radps : {0.3e-6, 0.99e-6, 1.01e-6, 1.3e-6, 1.9e-6, 5e-6, 1e-3}) {
    for (const double side : {1.0, -1.0}) {
      plan.segments[0] = {{1.0, side * rate_radps}, 60.0, 0.0};
      const double half_rad = 0.5 * side * rate_radps * 60.0;
      const double chord_m = 60.0 * std::sin(half_rad) / half_rad;
      const Eigen::Vector3d ends_m =
          chord_m * Eigen::Vector3d(std::cos(half_rad), std::sin(half_rad), 0.0);
      EXPECT_LT((point_at(plan, 60.0).position_world_m - ends_m).norm(), 2e-3) << rate_radps;
    }
  }
}

TEST(HoldPlan, AcceptsTheMaximumNumberOfSegments) {
  models::Trajectory way;
  way.start_time = kStart + from_seconds(3.5);
  way.start = {0.1, -0.2, 0.3};
  way.height_m = 1.4;
  for (std::size_t i = 0; i < HeldPlan::kSegmentsMax; ++i) {
    const double x = 1e-3 * static_cast<double>(i + 1);
    way.segments.push_back({{x, 2.0 * x}, 3.0 * x, 4.0 * x});
  }
  const HeldPlan plan = held(way);
  EXPECT_EQ(plan.start_time, way.start_time);
  EXPECT_EQ(plan.start.x_m, 0.1);
  EXPECT_EQ(plan.start.y_m, -0.2);
  EXPECT_EQ(plan.start.yaw_rad, 0.3);
  EXPECT_EQ(plan.height_m, 1.4);
  ASSERT_EQ(plan.count, way.segments.size());
  for (std::size_t i = 0; i < plan.count; ++i) {
    EXPECT_EQ(plan.segments[i].control.speed_mps, way.segments[i].control.speed_mps);
    EXPECT_EQ(plan.segments[i].control.yaw_rate_radps, way.segments[i].control.yaw_rate_radps);
    EXPECT_EQ(plan.segments[i].duration_s, way.segments[i].duration_s);
    EXPECT_EQ(plan.segments[i].brake_mps2, way.segments[i].brake_mps2);
  }
  EXPECT_NEAR(duration_s(plan), 3e-3 * 64.0 * 65.0 / 2.0, 1e-12);
}

// The storage is reused. Remaining segments of a longer earlier plan must have no effect, even if
// they are fast, tight, long or not finite.
TEST(HoldPlan, IgnoresOldSegmentsOfALongerPlan) {
  test::Random random(42);
  const SafetyLimits limits = limits_for(test::FlightBench::scenario(), "Q1");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  int accepted = 0;
  for (int i = 0; i < 300; ++i) {
    models::Trajectory way = random_way(random);
    for (models::PlanSegment& segment : way.segments) {
      segment.control.speed_mps *= i % 2 == 0 ? 0.2 : 1.0;  // every other plan is feasible
      segment.brake_mps2 = 0.0;
    }
    way.segments.push_back({{}, 0.1, 0.0});
    for (const models::PlanSegment& left : {models::PlanSegment{{9.0, 9.0}, 9.0, 0.0},
                                            {{0.5, 0.0}, 90.0, 0.0},
                                            {{nan, nan}, nan, nan}}) {
      models::Trajectory longer = way;
      longer.segments.assign(HeldPlan::kSegmentsMax, left);
      HeldPlan plan = held(longer);
      EXPECT_TRUE(hold_plan(way, plan));
      const HeldPlan fresh = held(way);
      EXPECT_EQ(duration_s(plan), duration_s(fresh));
      EXPECT_EQ(speed_max_mps(plan, 0.0, 60.0), speed_max_mps(fresh, 0.0, 60.0));
      for (const double t_s : {0.3, 5.0, 12.0}) {
        EXPECT_EQ(point_at(plan, t_s).position_world_m, point_at(fresh, t_s).position_world_m);
        EXPECT_EQ(point_at(plan, t_s).yaw_rad, point_at(fresh, t_s).yaw_rad);
      }
      const PlanVerdict verdict = check_shape(plan, limits);
      EXPECT_EQ(verdict, check_shape(fresh, limits)) << i;
      accepted += verdict == PlanVerdict::kAccepted ? 1 : 0;
    }
  }
  EXPECT_GT(accepted, 100);
  EXPECT_LT(accepted, 800);
}

}  // namespace
}  // namespace vantage::drivers
