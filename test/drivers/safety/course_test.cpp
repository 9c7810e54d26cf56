#include "drivers/quadrotor/safety/course.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "test/support/near.hpp"
#include "test/support/random.hpp"

namespace vantage::drivers {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr double kHalfWindowS = 0.25;
constexpr double kSpeedMps = 1.0;

Time after(double t_s) { return kStart + from_seconds(t_s); }

// Standing, driving and turning by turns, half a second each, and a stop.
HeldPlan random_plan(test::Random& random, Time start) {
  HeldPlan plan;
  plan.start_time = start;
  plan.start = {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-kPi, kPi)};
  plan.height_m = 1.0;
  plan.count = 8;
  for (std::size_t i = 0; i < plan.count; ++i) {
    const bool drives = random.uniform(0.0, 1.0) < 0.6;
    plan.segments[i] = {{drives ? kSpeedMps : 0.0, random.uniform(-3.0, 3.0)}, 0.5, 0.0};
  }
  return plan;
}

TEST(Course, AsksForNoMoreAccelerationThanTheWindowAllows) {
  test::Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    Course course(kHalfWindowS);
    const HeldPlan plan = random_plan(random, after(1.0));
    course.stand({plan.start.x_m, plan.start.y_m, 1.0}, plan.start.yaw_rad, kStart);
    course.follow(plan, kStart);
    Eigen::Vector3d last_mps = Eigen::Vector3d::Zero();
    for (double t_s = 0.0; t_s < 6.0; t_s += 0.01) {
      course.advance(after(t_s), 0.01, 1.0);
      const PlanPoint here = course.at(after(t_s));
      // Two velocities of at most v differ by at most 2 v; turning on the spot needs none.
      EXPECT_LE(here.acceleration_world_mps2.norm(), kSpeedMps / kHalfWindowS + 1e-9);
      EXPECT_LE((here.velocity_world_mps - last_mps).norm(),
                0.01 * kSpeedMps / kHalfWindowS + 1e-9);
      // Averages of points of a way stay within v × half the mean distance in time.
      const PlanPoint planned = course.planned_at(after(t_s));
      EXPECT_LE((here.position_world_m - planned.position_world_m).norm(),
                0.5 * kSpeedMps * kHalfWindowS + 1e-9);
      last_mps = here.velocity_world_mps;
    }
    EXPECT_TRUE(test::is_near(course.at(after(6.0)).position_world_m,
                              course.planned_at(after(6.0)).position_world_m, 1e-12));
  }
}

TEST(Course, AsksForVelocitiesThatAreTheDerivativesOfItsPlaces) {
  test::Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    Course course(kHalfWindowS);
    course.follow(random_plan(random, kStart), kStart);
    const double t_s = random.uniform(0.5, 3.5);
    const double h_s = 0.05;
    const PlanPoint before = course.at(after(t_s - h_s));
    const PlanPoint here = course.at(after(t_s));
    const PlanPoint later = course.at(after(t_s + h_s));
    // Velocities change by at most 4 m/s² and yaw rates by 12 rad/s², which bounds the error of a
    // difference over 2 h; trapezoids add some millimetres.
    EXPECT_TRUE(test::is_near((later.position_world_m - before.position_world_m) / (2.0 * h_s),
                              here.velocity_world_mps, 4.0 * h_s));
    EXPECT_NEAR(wrap_to_pi(later.yaw_rad - before.yaw_rad) / (2.0 * h_s), here.yaw_rate_radps,
                12.0 * h_s);
  }
}

// In closed form: from standing to v at t = 0, the mean over ±w is v (t + w)² / (4 w), and v w / 4
// at the corner itself.
TEST(Course, SetsOffBeforeThePlanDoesAndCutsTheCornerAsStated) {
  HeldPlan plan;
  plan.start_time = after(1.0);
  plan.count = 1;
  plan.segments[0] = {{kSpeedMps, 0.0}, 3.0, 0.0};
  Course course(kHalfWindowS);
  course.stand(Eigen::Vector3d::Zero(), 0.0, kStart);
  course.follow(plan, kStart);
  const double w_s = kHalfWindowS;
  for (const double t_s : {-0.25, -0.2, -0.1, 0.0, 0.1, 0.2, 0.25}) {
    const PlanPoint here = course.at(after(1.0 + t_s));
    // Trapezoids of width w/8 err by up to v (w/8)² / 8 of a corner's area, over 2 w.
    EXPECT_NEAR(here.position_world_m.x(), kSpeedMps * (t_s + w_s) * (t_s + w_s) / (4.0 * w_s),
                3e-4);
    EXPECT_NEAR(here.velocity_world_mps.x(), kSpeedMps * (t_s + w_s) / (2.0 * w_s), 1e-6);
  }
  EXPECT_NEAR(course.at(after(1.0)).position_world_m.x(), kSpeedMps * w_s / 4.0, 3e-4);
}

TEST(Course, ForgetsAPlanThatHasNotBegun) {
  test::Random random(5);
  const HeldPlan plan = random_plan(random, after(0.1));
  Course course(kHalfWindowS);
  const Eigen::Vector3d place_m(plan.start.x_m, plan.start.y_m, 1.0);
  course.stand(place_m, 0.3, kStart);
  course.follow(plan, kStart);
  EXPECT_TRUE(course.has_next());
  course.forget_next();
  for (double t_s = 0.0; t_s < 3.0; t_s += 0.01) {
    course.advance(after(t_s), 0.01, 1.0);
    EXPECT_EQ(course.at(after(t_s)).position_world_m, place_m);
  }
  EXPECT_FALSE(course.is_on_plan());
}

TEST(Course, GoesFromPlanToPlanWithoutAJump) {
  HeldPlan first;
  first.start_time = kStart;
  first.count = 1;
  first.segments[0] = {{kSpeedMps, 0.0}, 2.0, 0.0};
  HeldPlan second = first;
  second.start_time = after(1.0);
  second.start.x_m = 1.0;
  second.segments[0].control.yaw_rate_radps = 2.0;
  Course course(kHalfWindowS);
  course.follow(first, kStart);
  course.follow(second, kStart);
  PlanPoint last = course.at(after(0.3));
  for (double t_s = 0.31; t_s < 2.0; t_s += 0.01) {
    course.advance(after(t_s), 0.01, 1.0);
    const PlanPoint here = course.at(after(t_s));
    EXPECT_LE((here.position_world_m - last.position_world_m).norm(), 0.011 * kSpeedMps);
    EXPECT_LE((here.velocity_world_mps - last.velocity_world_mps).norm(), 0.05);
    last = here;
  }
}

TEST(Course, ShiftsFromRestToRest) {
  test::Random random(6);
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Vector3d from_m = random.vector<3>(-1.0, 1.0);
    const Eigen::Vector3d to_m = random.vector<3>(-1.0, 1.0);
    constexpr double kShiftMps = 0.4;
    Course course(kHalfWindowS);
    course.stand(from_m, 0.3, kStart);
    course.shift(to_m, kShiftMps, kStart);
    EXPECT_TRUE(test::is_near(course.at(kStart).position_world_m, from_m, 1e-12));
    EXPECT_EQ(course.at(kStart).velocity_world_mps.norm(), 0.0);
    Eigen::Vector3d last_mps = Eigen::Vector3d::Zero();
    double t_s = 0.0;
    for (; !course.is_standing(after(t_s)); t_s += 0.01) {
      ASSERT_LT(t_s, 10.0);
      const Eigen::Vector3d now_mps = course.at(after(t_s)).velocity_world_mps;
      EXPECT_LE(now_mps.norm(), kShiftMps + 1e-9);
      EXPECT_LE((now_mps - last_mps).norm(), 0.01 * kShiftMps / (2.0 * kHalfWindowS) + 1e-9);
      last_mps = now_mps;
    }
    EXPECT_NEAR(t_s, (to_m - from_m).norm() / kShiftMps + 2.0 * kHalfWindowS, 0.011);
    EXPECT_TRUE(test::is_near(course.at(after(t_s)).position_world_m, to_m, 1e-12));
    EXPECT_LE(course.at(after(t_s)).velocity_world_mps.norm(), 1e-9);
  }
}

}  // namespace
}  // namespace vantage::drivers
