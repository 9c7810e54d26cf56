#include "drivers/safety/course.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

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

// Returns a random plan of stationary, driving and turning segments, 0.5 s each, and a final stop.
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

TEST(Course, LimitsAccelerationByItsWindow) {
  test::Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    Course course(kHalfWindowS);
    const HeldPlan plan = random_plan(random, after(1.0));
    course.hover({plan.start.x_m, plan.start.y_m, 1.0}, plan.start.yaw_rad, kStart);
    course.follow(plan, kStart);
    Eigen::Vector3d last_mps = Eigen::Vector3d::Zero();
    for (double t_s = 0.0; t_s < 6.0; t_s += 0.01) {
      course.advance(after(t_s), 0.01, 1.0);
      const Setpoint here = course.at(after(t_s));
      // The acceleration is the difference of two velocities of at most v over the window 2 w: at
      // most v/w.
      EXPECT_LE(here.acceleration_world_mps2.norm(), kSpeedMps / kHalfWindowS + 1e-9);
      EXPECT_LE((here.velocity_world_mps - last_mps).norm(),
                0.01 * kSpeedMps / kHalfWindowS + 1e-9);
      // The averaged position differs from the planned one by at most v × the mean time difference
      // within the window.
      const Setpoint planned = course.planned_at(after(t_s));
      EXPECT_LE((here.position_world_m - planned.position_world_m).norm(),
                0.5 * kSpeedMps * kHalfWindowS + 1e-9);
      last_mps = here.velocity_world_mps;
    }
    EXPECT_TRUE(test::is_near(course.at(after(6.0)).position_world_m,
                              course.planned_at(after(6.0)).position_world_m, 1e-12));
  }
}

TEST(Course, VelocityIsTheDerivativeOfPosition) {
  test::Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    Course course(kHalfWindowS);
    course.follow(random_plan(random, kStart), kStart);
    const double t_s = random.uniform(0.5, 3.5);
    const double h_s = 0.05;
    const Setpoint before = course.at(after(t_s - h_s));
    const Setpoint here = course.at(after(t_s));
    const Setpoint later = course.at(after(t_s + h_s));
    // The velocity changes by at most 4 m/s² and the yaw rate by at most 12 rad/s². This bounds the
    // error of a difference quotient over 2 h; the trapezoidal rule adds some millimetres.
    EXPECT_TRUE(test::is_near((later.position_world_m - before.position_world_m) / (2.0 * h_s),
                              here.velocity_world_mps, 4.0 * h_s));
    EXPECT_NEAR(wrap_to_pi(later.yaw_rad - before.yaw_rad) / (2.0 * h_s), here.yaw_rate_radps,
                12.0 * h_s);
  }
}

// A plan changes from rest to speed v at t = 0. In closed form the mean position over ±w is v (t +
// w)² / (4 w), so it is v w / 4 at t = 0.
TEST(Course, SmoothsTheStartOfAPlanAsInClosedForm) {
  HeldPlan plan;
  plan.start_time = after(1.0);
  plan.count = 1;
  plan.segments[0] = {{kSpeedMps, 0.0}, 3.0, 0.0};
  Course course(kHalfWindowS);
  course.hover(Eigen::Vector3d::Zero(), 0.0, kStart);
  course.follow(plan, kStart);
  const double w_s = kHalfWindowS;
  for (const double t_s : {-0.25, -0.2, -0.1, 0.0, 0.1, 0.2, 0.25}) {
    const Setpoint here = course.at(after(1.0 + t_s));
    // The trapezoidal rule with width w/8 has an area error of up to v (w/8)² / 8 at a corner,
    // divided by the window length 2 w.
    EXPECT_NEAR(here.position_world_m.x(), kSpeedMps * (t_s + w_s) * (t_s + w_s) / (4.0 * w_s),
                3e-4);
    EXPECT_NEAR(here.velocity_world_mps.x(), kSpeedMps * (t_s + w_s) / (2.0 * w_s), 1e-6);
  }
  EXPECT_NEAR(course.at(after(1.0)).position_world_m.x(), kSpeedMps * w_s / 4.0, 3e-4);
}

TEST(Course, DropsAPlanThatHasNotStarted) {
  test::Random random(5);
  const HeldPlan plan = random_plan(random, after(0.1));
  Course course(kHalfWindowS);
  const Eigen::Vector3d place_m(plan.start.x_m, plan.start.y_m, 1.0);
  course.hover(place_m, 0.3, kStart);
  course.follow(plan, kStart);
  EXPECT_TRUE(course.has_next());
  course.forget_next();
  for (double t_s = 0.0; t_s < 3.0; t_s += 0.01) {
    course.advance(after(t_s), 0.01, 1.0);
    EXPECT_EQ(course.at(after(t_s)).position_world_m, place_m);
  }
  EXPECT_FALSE(course.is_on_plan());
}

TEST(Course, ChangesPlansWithoutAJump) {
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
  Setpoint last = course.at(after(0.3));
  for (double t_s = 0.31; t_s < 2.0; t_s += 0.01) {
    course.advance(after(t_s), 0.01, 1.0);
    const Setpoint here = course.at(after(t_s));
    EXPECT_LE((here.position_world_m - last.position_world_m).norm(), 0.011 * kSpeedMps);
    EXPECT_LE((here.velocity_world_mps - last.velocity_world_mps).norm(), 0.05);
    last = here;
  }
}

TEST(Course, ShiftBeginsAndEndsAtZeroSpeed) {
  test::Random random(6);
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Vector3d from_m = random.vector<3>(-1.0, 1.0);
    const Eigen::Vector3d to_m = random.vector<3>(-1.0, 1.0);
    constexpr double kShiftMps = 0.4;
    Course course(kHalfWindowS);
    course.hover(from_m, 0.3, kStart);
    course.shift(to_m, kShiftMps, kStart);
    EXPECT_TRUE(test::is_near(course.at(kStart).position_world_m, from_m, 1e-12));
    EXPECT_EQ(course.at(kStart).velocity_world_mps.norm(), 0.0);
    Eigen::Vector3d last_mps = Eigen::Vector3d::Zero();
    double t_s = 0.0;
    for (; !course.is_hovering(after(t_s)); t_s += 0.01) {
      ASSERT_LT(t_s, 10.0);
      const Eigen::Vector3d now_mps = course.at(after(t_s)).velocity_world_mps;
      EXPECT_LE(now_mps.norm(), kShiftMps + 1e-9);
      EXPECT_LE((now_mps - last_mps).norm(), 0.01 * kShiftMps / (2.0 * kHalfWindowS) + 1e-9);
      last_mps = now_mps;
      constexpr double kStep_s = 1e-3;
      const Setpoint before = course.at(after(t_s - kStep_s));
      const Setpoint behind = course.at(after(t_s + kStep_s));
      if (test::is_near(before.acceleration_world_mps2, behind.acceleration_world_mps2, 1e-9)) {
        const Eigen::Vector3d faster_mps = behind.velocity_world_mps - before.velocity_world_mps;
        EXPECT_TRUE(test::is_near(course.at(after(t_s)).acceleration_world_mps2,
                                  faster_mps / (2.0 * kStep_s), 1e-6));
      }
    }
    EXPECT_NEAR(t_s, (to_m - from_m).norm() / kShiftMps + 2.0 * kHalfWindowS, 0.011);
    EXPECT_TRUE(test::is_near(course.at(after(t_s)).position_world_m, to_m, 1e-12));
    EXPECT_LE(course.at(after(t_s)).velocity_world_mps.norm(), 1e-9);
  }
}

/// Returns `plan`, moved so that it begins at `start` at the position of the course at that time.
HeldPlan continued(HeldPlan plan, const Course& course, Time start) {
  const Setpoint there = course.planned_at(start);
  plan.start_time = start;
  plan.start = {there.position_world_m.x(), there.position_world_m.y(), there.yaw_rad};
  return plan;
}

HeldPlan driving(double rate_radps, Time start) {
  HeldPlan plan;
  plan.start_time = start;
  plan.height_m = 1.0;
  plan.count = 1;
  plan.segments[0] = {{kSpeedMps, rate_radps}, 4.0, 0.0};
  return plan;
}

// A slowed plan lags behind its clock, so the next plan begins at the delayed position. Three plans
// in a row show that the second does not use the history of the first.
TEST(Course, ContinuesWithoutAJumpAfterASlowedPlan) {
  for (const double side : {1.0, -1.0}) {
    Course course(kHalfWindowS);
    course.follow(driving(0.0, kStart), kStart);
    Setpoint last = course.at(kStart);
    double t_s = 0.0;
    const auto fly = [&](double until_s, double rate) {
      for (; t_s < until_s; t_s += 0.01) {
        course.advance(after(t_s), 0.01, rate);
        const Setpoint here = course.at(after(t_s));
        EXPECT_LE((here.position_world_m - last.position_world_m).norm(), 0.011 * kSpeedMps) << t_s;
        EXPECT_LE(std::abs(wrap_to_pi(here.yaw_rad - last.yaw_rad)), 0.031) << t_s;
        last = here;
      }
    };
    fly(0.5, 1.0);
    for (int plan = 1; plan <= 3; ++plan) {
      const double slow_s = 0.1 * plan;  // s; a different lag for each plan
      const double from_s = t_s;
      fly(from_s + slow_s, 0.0);
      EXPECT_NEAR(to_seconds(after(t_s) - course.plan().start_time) - course.elapsed_s(after(t_s)),
                  slow_s, 0.011)
          << plan;
      const Time start = after(t_s + 0.5);
      course.follow(continued(driving(side * plan, start), course, start), after(t_s));
      EXPECT_TRUE(course.has_next());
      fly(t_s + 1.2, 1.0);
      EXPECT_FALSE(course.has_next());
      EXPECT_EQ(course.plan().start_time, start);
    }
  }
}

// A stop discards earlier plans: a plan that begins during a hover starts at the hover position.
// Tested twice.
TEST(Course, ForgetsPlansBeforeAStop) {
  Course course(kHalfWindowS);
  for (int time = 0; time < 2; ++time) {
    const double begin_s = 10.0 * time;
    for (int leg = 0; leg < 2; ++leg) {  // two plans in sequence create a history
      course.follow(continued(driving(0.5, after(begin_s)), course, after(begin_s + leg)),
                    after(begin_s + leg));
      course.advance(after(begin_s + leg), 0.01, 1.0);
    }
    const Eigen::Vector3d place_m(5.0, 5.0, 1.0);
    course.hover(place_m, 0.3, after(begin_s + 2.0));
    HeldPlan next = driving(0.0, after(begin_s + 3.0));
    next.start = {place_m.x(), place_m.y(), 0.3};
    course.follow(next, after(begin_s + 3.0));
    for (const double before_s : {0.01, 0.2, 1.0}) {
      const Setpoint here = course.planned_at(after(begin_s + 3.0 - before_s));
      EXPECT_TRUE(test::is_near(here.position_world_m, place_m, 1e-12)) << before_s;
      EXPECT_EQ(here.velocity_world_mps.norm(), 0.0);
    }
    course.hover(place_m, 0.3, after(begin_s + 4.0));
  }
}

TEST(Course, OnTimeReturnsThePositionOfAnUnslowedCourse) {
  Course slowed(kHalfWindowS);
  Course never(kHalfWindowS);
  const HeldPlan plan = driving(0.7, kStart);
  slowed.follow(plan, kStart);
  never.follow(plan, kStart);
  for (int tick = 1; tick <= 200; ++tick) {
    const double rate = tick % 50 < 20 ? 0.25 : 1.0;
    slowed.advance(after(0.01 * tick), 0.01, rate);
    never.advance(after(0.01 * tick), 0.01, 1.0);
  }
  const double lag_s = 0.01 * 0.75 * (19 + 20 + 20 + 20 + 1);
  EXPECT_NEAR(slowed.elapsed_s(after(2.0)), 2.0 - lag_s, 1e-9);
  EXPECT_TRUE(test::is_near(slowed.on_time(after(2.0)).position_world_m,
                            never.at(after(2.0)).position_world_m, 1e-12));
  EXPECT_TRUE(test::is_near(slowed.at(after(2.0 + lag_s)).position_world_m,
                            never.at(after(2.0)).position_world_m, 1e-5));
}

// If a next plan is expected, the predicted path beyond the round continues straight until the next
// plan arrives or is due. Tested for the first plan and the next one.
TEST(Course, ContinuesStraightUntilTheNextPlan) {
  constexpr double kRoundS = 1.0;
  Course course(kHalfWindowS, kRoundS);
  HeldPlan turns;
  turns.height_m = 1.0;
  turns.count = 2;
  turns.segments[0] = {{kSpeedMps, 0.0}, kRoundS, 0.0};
  turns.segments[1] = {{kSpeedMps, 2.0}, 1.0, 0.0};
  for (int round = 0; round < 2; ++round) {
    const double begin_s = 2.0 * round;
    turns.start_time = after(begin_s);
    turns.start = {static_cast<double>(round), 0.0, 0.0};
    course.follow(turns, after(begin_s));
    course.advance(after(begin_s + 0.5), 0.01, 1.0);
    const Setpoint believed = course.planned_at(after(begin_s + 1.5));
    EXPECT_TRUE(
        test::is_near(believed.position_world_m, Eigen::Vector3d(round + 1.5, 0.0, 1.0), 1e-9));
    EXPECT_EQ(believed.yaw_rate_radps, 0.0);
    EXPECT_NEAR(believed.yaw_rad, 0.0, 1e-12);
    EXPECT_TRUE(test::is_near(course.planned_at(after(begin_s + 0.9)).position_world_m,
                              Eigen::Vector3d(round + 0.9, 0.0, 1.0), 1e-9));
    course.advance(after(begin_s + kRoundS), 0.01, 1.0);  // next plan due, but not received
    EXPECT_NEAR(course.planned_at(after(begin_s + 1.5)).yaw_rad, 1.0, 1e-9);
  }
}

TEST(Course, HasAPlanUntilThePlanEnds) {
  const HeldPlan plan = driving(0.0, kStart);
  Course course(kHalfWindowS);
  EXPECT_FALSE(course.has_plan(kStart));
  EXPECT_TRUE(course.is_hovering(kStart));
  for (int time = 0; time < 2; ++time) {
    course.follow(plan, kStart);
    EXPECT_TRUE(course.is_on_plan());
    EXPECT_TRUE(course.has_plan(after(4.0)));
    EXPECT_FALSE(course.has_plan(after(4.0) + Duration{1}));
    EXPECT_FALSE(course.is_hovering(after(9.0)));
    const BrakingPath way = BrakingPath::along(plan, 1.0, 2.0, 0.2, {0.1, 0.0, 0.0});
    HeldPlan next = plan;
    next.start_time = after(8.0);
    course.follow(next, after(1.0));
    course.stop(way, after(1.0));
    EXPECT_FALSE(course.has_next()) << "a stop drops all plans";
    EXPECT_FALSE(course.is_on_plan());
    EXPECT_FALSE(course.has_plan(after(1.0)));
    EXPECT_FALSE(course.is_hovering(after(1.69)));
    EXPECT_TRUE(course.is_hovering(after(1.70))) << "0.2 s and 1 m/s at 2 m/s²";
    course.follow(next, after(2.0));
    course.shift({1.0, 0.0, 1.0}, 0.5, after(2.0));
    EXPECT_FALSE(course.has_next());
    EXPECT_FALSE(course.is_hovering(after(2.1)));
    course.follow(next, after(2.0));
    course.hover({1.0, 0.0, 1.0}, 0.0, after(5.0));
    EXPECT_FALSE(course.has_next());
    EXPECT_TRUE(course.is_hovering(after(5.0)));
  }
}

// Compares the braking path with a numerical integration in small steps: constant velocity during
// the reaction time, then braking to rest.
TEST(BrakingPath, MatchesTheEquationsOfMotion) {
  test::Random random(7);
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d v_mps = random.vector<3>(-1.0, 1.0);
    const Eigen::Vector3d from_m = random.vector<3>(-1.0, 1.0);
    const double brake_mps2 = random.uniform(0.5, 3.0);
    const double reaction_s = random.uniform(0.0, 0.4);
    const BrakingPath way = BrakingPath::straight(from_m, v_mps, 0.4, brake_mps2, reaction_s);
    EXPECT_NEAR(way.duration_s(), reaction_s + v_mps.norm() / brake_mps2, 1e-12);
    Eigen::Vector3d p_m = from_m;
    constexpr double kStepS = 1e-4;
    for (int i = 0; i < 20000; ++i) {
      const double t_s = kStepS * i;
      const double braking_s = std::max(0.0, t_s - reaction_s);
      const double speed_mps = std::max(0.0, v_mps.norm() - brake_mps2 * braking_s);
      if (i % 500 == 0) {
        const Setpoint at = way.at(t_s);
        EXPECT_TRUE(test::is_near(at.position_world_m, p_m, 5e-4)) << t_s;
        EXPECT_NEAR(at.velocity_world_mps.norm(), speed_mps, 1e-9) << t_s;
        EXPECT_EQ(at.yaw_rad, 0.4);
        const bool brakes = braking_s > 0.0 && speed_mps > 0.0;
        EXPECT_NEAR(at.acceleration_world_mps2.norm(), brakes ? brake_mps2 : 0.0, 1e-9) << t_s;
        EXPECT_LE(at.acceleration_world_mps2.dot(v_mps), 0.0);
      }
      p_m += kStepS * speed_mps * v_mps.normalized();
    }
    EXPECT_EQ(way.at(100.0).position_world_m, way.at(way.duration_s()).position_world_m);
    EXPECT_EQ(way.at(-1.0).position_world_m, from_m);
  }
}

// While the vehicle follows a plan, its braking path is the planned path, shifted to the vehicle,
// and ends at rest. Later parts of the plan have no effect.
TEST(BrakingPath, FollowsThePlannedPathUntilStationary) {
  test::Random random(8);
  for (int trial = 0; trial < 200; ++trial) {
    const HeldPlan plan = random_plan(random, kStart);
    const double from_s = random.uniform(0.0, 3.9);
    const Eigen::Vector3d offset_m = random.vector<3>(-0.2, 0.2);
    const BrakingPath way = BrakingPath::along(plan, from_s, 2.0, 0.2, offset_m);
    const double fastest_mps = std::max(point_at(plan, from_s).velocity_world_mps.norm(),
                                        point_at(plan, from_s + 0.2).velocity_world_mps.norm());
    const double brake_s = fastest_mps / 2.0;
    EXPECT_NEAR(way.duration_s(), 0.2 + brake_s, 1e-12);
    for (double t_s = 0.0; t_s < 1.5; t_s += 0.01) {
      const double u_s = std::clamp(t_s - 0.2, 0.0, brake_s);
      const double gone_s =
          std::min(t_s, 0.2) + (brake_s > 0.0 ? u_s - u_s * u_s / (2.0 * brake_s) : 0.0);
      const Setpoint planned = point_at(plan, from_s + gone_s);
      const Setpoint here = way.at(t_s);
      EXPECT_TRUE(test::is_near(here.position_world_m, planned.position_world_m + offset_m, 1e-9));
      EXPECT_NEAR(wrap_to_pi(here.yaw_rad - planned.yaw_rad), 0.0, 1e-9);
      const double rate = brake_s > 0.0 ? 1.0 - u_s / brake_s : 0.0;
      EXPECT_TRUE(test::is_near(here.velocity_world_mps, rate * planned.velocity_world_mps, 1e-9));
      EXPECT_NEAR(here.yaw_rate_radps, rate * planned.yaw_rate_radps, 1e-9);
    }
  }
}

// Mirroring, rotation and a time shift do not change the result.
TEST(Course, IsInvariantUnderMirrorRotationAndTime) {
  test::Random random(9);
  for (int trial = 0; trial < 100; ++trial) {
    const HeldPlan plan = random_plan(random, after(0.4));
    const HeldPlan next = random_plan(random, after(2.4));
    const double turn_rad = random.uniform(-kPi, kPi);
    const double side = random.coin() ? 1.0 : -1.0;
    const Duration later = from_seconds(random.uniform(-1e6, 1e6));
    Eigen::Matrix3d other_from_here =
        Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    other_from_here.col(1) *= side;
    const auto seen = [&](HeldPlan p) {
      const Eigen::Vector3d start_m =
          other_from_here * Eigen::Vector3d(p.start.x_m, p.start.y_m, 0.0);
      p.start = {start_m.x(), start_m.y(), wrap_to_pi(turn_rad + side * p.start.yaw_rad)};
      p.start_time += later;
      for (models::PlanSegment& segment : p.segments) {
        segment.control.yaw_rate_radps *= side;
      }
      return p;
    };
    Course here(kHalfWindowS, 1.0);
    Course there(kHalfWindowS, 1.0);
    here.hover({plan.start.x_m, plan.start.y_m, 1.0}, plan.start.yaw_rad, kStart);
    const HeldPlan seen_plan = seen(plan);
    there.hover({seen_plan.start.x_m, seen_plan.start.y_m, 1.0}, seen_plan.start.yaw_rad,
                kStart + later);
    here.follow(plan, kStart);
    there.follow(seen_plan, kStart + later);
    for (int tick = 0; tick < 400; ++tick) {
      const Time t = after(0.01 * tick);
      const double rate = tick % 100 < 30 ? 0.3 : 1.0;
      if (tick == 200) {
        here.follow(next, t);
        there.follow(seen(next), t + later);
      } else if (tick == 350) {
        here.stop(
            BrakingPath::along(here.plan(), here.elapsed_s(t), 2.0, 0.2, Eigen::Vector3d::Zero()),
            t);
        there.stop(BrakingPath::along(there.plan(), there.elapsed_s(t + later), 2.0, 0.2,
                                      Eigen::Vector3d::Zero()),
                   t + later);
      }
      here.advance(t, 0.01, rate);
      there.advance(t + later, 0.01, rate);
      const Setpoint a = here.at(t);
      const Setpoint b = there.at(t + later);
      EXPECT_TRUE(test::is_near(b.position_world_m, other_from_here * a.position_world_m, 1e-9));
      EXPECT_TRUE(
          test::is_near(b.velocity_world_mps, other_from_here * a.velocity_world_mps, 1e-9));
      EXPECT_TRUE(test::is_near(b.acceleration_world_mps2,
                                other_from_here * a.acceleration_world_mps2, 1e-8));
      EXPECT_NEAR(wrap_to_pi(b.yaw_rad - (turn_rad + side * a.yaw_rad)), 0.0, 1e-9);
      EXPECT_NEAR(b.yaw_rate_radps, side * a.yaw_rate_radps, 1e-9);
    }
  }
}

}  // namespace
}  // namespace vantage::drivers
