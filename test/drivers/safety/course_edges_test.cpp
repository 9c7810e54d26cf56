// Compares the set-points of a course at its start and end instants with closed forms.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "drivers/safety/course.hpp"
#include "test/support/near.hpp"
#include "test/support/random.hpp"

namespace vantage::drivers {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr double kHalfWindowS = 0.25;
constexpr double kSpeedMps = 1.0;
constexpr Duration kInstant{1};

Time after(double t_s) { return kStart + from_seconds(t_s); }

HeldPlan driving(const Pose2& from, double speed_mps, double rate_radps, Time start) {
  HeldPlan plan;
  plan.start_time = start;
  plan.start = from;
  plan.height_m = 1.0;
  plan.count = 1;
  plan.segments[0] = {{speed_mps, rate_radps}, 4.0, 0.0};
  return plan;
}

void expect_same(const Setpoint& is, const Setpoint& should_be) {
  EXPECT_TRUE(test::is_near(is.position_world_m, should_be.position_world_m, 1e-12));
  EXPECT_TRUE(test::is_near(is.velocity_world_mps, should_be.velocity_world_mps, 1e-12));
  EXPECT_TRUE(test::is_near(is.acceleration_world_mps2, should_be.acceleration_world_mps2, 1e-12));
  EXPECT_NEAR(wrap_to_pi(is.yaw_rad - should_be.yaw_rad), 0.0, 1e-12);
  EXPECT_NEAR(is.yaw_rate_radps, should_be.yaw_rate_radps, 1e-12);
}

// Shifts and abrupt speed changes of plans are smoothed. A stop is followed exactly, with or
// without a later plan. Tested repeatedly.
TEST(Course, FollowsAStopExactly) {
  test::Random random(21);
  Course course(kHalfWindowS);
  for (int time = 0; time < 20; ++time) {
    const double begin_s = 30.0 * time;
    const HeldPlan plan =
        driving(random.pose2(1.0), kSpeedMps, random.uniform(-2.0, 2.0), after(begin_s));
    course.follow(plan, after(begin_s));
    course.advance(after(begin_s), 0.01, 1.0);
    const double stop_s = random.uniform(0.5, 3.0);
    const BrakingPath way = BrakingPath::along(plan, stop_s, 2.0, 0.2, random.vector<3>(-0.1, 0.1));
    course.stop(way, after(begin_s + stop_s));
    if (time % 2 == 1) {
      course.follow(driving(random.pose2(1.0), kSpeedMps, 0.0, after(begin_s + 20.0)),
                    after(begin_s + stop_s));
    }
    for (double t_s = 0.0; t_s < 1.5; t_s += 0.05) {
      const Time t = after(begin_s + stop_s) + from_seconds(t_s);
      expect_same(course.at(t), way.at(to_seconds(t - after(begin_s + stop_s))));
      expect_same(course.planned_at(t), course.at(t));
    }
    course.forget_next();
  }
}

TEST(Course, EqualsThePlanIfTheWindowIsZero) {
  Course course(0.0);
  const HeldPlan plan = driving({0.3, -0.2, 1.0}, kSpeedMps, 0.7, kStart);
  course.hover({0.3, -0.2, 1.0}, 1.0, kStart);
  EXPECT_EQ(course.at(kStart).position_world_m, Eigen::Vector3d(0.3, -0.2, 1.0));
  course.follow(plan, kStart);
  for (int tick = 1; tick <= 100; ++tick) {
    const Time t = after(0.01 * tick);
    course.advance(t, 0.01, 0.4);
    expect_same(course.at(t), point_at(plan, 0.4 * 0.01 * tick));
    expect_same(course.on_time(t), point_at(plan, 0.01 * tick));
  }
}

// A plan applies exactly from its start time: after a hover or another plan, and whether or not the
// course was advanced before. Once a plan that followed a hover has begun, the course returns the
// plan's start position for earlier times.
TEST(Course, FollowsAPlanFromItsStartTime) {
  Course course(kHalfWindowS);
  Eigen::Vector3d before_m(5.0, 5.0, 1.0);
  course.hover(before_m, 0.3, kStart);
  for (int i = 1; i <= 3; ++i) {
    const Time start = after(i);
    const Eigen::Vector3d begins_m(-1.0 * i, 2.0, 1.0);
    course.follow(driving({-1.0 * i, 2.0, 0.0}, kSpeedMps, 0.0, start), after(i - 0.5));
    const auto expect_jump = [&](const Eigen::Vector3d& from_m) {
      EXPECT_TRUE(
          test::is_near(course.planned_at(start - kInstant).position_world_m, from_m, 2e-6));
      EXPECT_EQ(course.planned_at(start).position_world_m, begins_m);
    };
    expect_jump(before_m);
    course.advance(start - kInstant, 0.01, 1.0);
    EXPECT_TRUE(course.has_next());
    EXPECT_NE(course.plan().start_time, start);
    expect_jump(before_m);
    course.advance(start, 0.01, 1.0);
    EXPECT_FALSE(course.has_next());
    EXPECT_TRUE(course.is_on_plan());
    EXPECT_EQ(course.plan().start_time, start);
    expect_jump(i == 1 ? begins_m : before_m);
    before_m = begins_m + Eigen::Vector3d(kSpeedMps, 0.0, 0.0);
  }
}

// A plan changes from rest to speed v and yaw rate ω at t = 0. Both change only while the averaging
// window contains t = 0, at the rates v/(2 w) and ω/(2 w).
TEST(Course, ChangesItsSpeedOnlyWithinTheWindow) {
  constexpr double kW = kHalfWindowS;
  for (const double rate_radps : {2.0, -2.0}) {
    for (const double speed_mps : {kSpeedMps, 0.0}) {
      Course course(kHalfWindowS);
      course.hover({0.0, 0.0, 1.0}, 0.0, kStart);
      const double turns_radps = speed_mps > 0.0 ? 0.0 : rate_radps;
      course.follow(driving({0.0, 0.0, 0.0}, speed_mps, turns_radps, after(1.0)), kStart);
      for (const double t_s : {-0.3, -0.250001, -0.25, -0.1, 0.0, 0.1, 0.249999, 0.25, 0.3}) {
        const Setpoint here = course.at(after(1.0 + t_s));
        const bool changes = t_s >= -kW && t_s < kW;
        EXPECT_NEAR(here.acceleration_world_mps2.x(), changes ? speed_mps / (2.0 * kW) : 0.0, 1e-9)
            << t_s;
        const double share = std::clamp((t_s + kW) / (2.0 * kW), 0.0, 1.0);
        EXPECT_NEAR(here.yaw_rate_radps, turns_radps * share, 1e-9) << t_s;
        // The trapezoidal rule with width w/8 has an area error of up to ω (w/8)² / 8 at a corner,
        // divided by the window length 2 w.
        const double turned_rad = turns_radps * (kW * share * share + std::max(0.0, t_s - kW));
        EXPECT_NEAR(here.yaw_rad, turned_rad, 6e-4) << t_s;
      }
    }
  }
}

// Compares a shift from rest to rest with its closed form: v τ²/(4 w) during the acceleration, then
// the constant-speed path delayed by w, then the mirrored deceleration. The shift starts from a
// hover, from the end of the first shift, or from the end of a stop.
TEST(Course, ShiftStartsAtTheCurrentPosition) {
  constexpr double kShiftMps = 0.4;
  constexpr double kW = kHalfWindowS;
  Course course(kHalfWindowS);
  Eigen::Vector3d here_m(0.3, -1.0, 1.0);
  course.hover(here_m, -0.3, kStart);
  double begin_s = 3.0;
  const auto expect_shift = [&](const Eigen::Vector3d& to_m) {
    course.shift(to_m, kShiftMps, after(begin_s));
    const double length_m = (to_m - here_m).norm();
    const double end_s = length_m / kShiftMps + 2.0 * kW;
    const auto gone_m = [&](double t_s) {
      return kShiftMps * (t_s < 2.0 * kW ? t_s * t_s / (4.0 * kW) : t_s - kW);
    };
    for (double t_s = 0.0; t_s <= end_s; t_s += 0.01) {
      const double along_m = t_s < 0.5 * end_s ? gone_m(t_s) : length_m - gone_m(end_s - t_s);
      const Setpoint there = course.at(after(begin_s + t_s));
      EXPECT_TRUE(test::is_near(there.position_world_m,
                                here_m + along_m / length_m * (to_m - here_m), 3e-4))
          << t_s;
      EXPECT_NEAR(there.yaw_rad, -0.3, 1e-12);
      EXPECT_EQ(there.yaw_rate_radps, 0.0);
    }
    here_m = to_m;
    begin_s += 20.0;
  };
  expect_shift({1.3, 1.0, 1.0});
  expect_shift({0.3, -1.0, 1.0});
  const BrakingPath way = BrakingPath::straight({-1.0, 1.0, 1.0}, {0.6, 0.8, 0.0}, -0.3, 2.0, 0.2);
  course.stop(way, after(begin_s));
  here_m = way.at(way.duration_s()).position_world_m;
  begin_s += 2.0;
  expect_shift({1.0, 1.0, 1.0});
}

// A shift or a hover that begins in the middle of a turn starts and ends with zero speed, turn rate
// and acceleration.
TEST(Course, ShiftAndHoverBeginAtZeroSpeed) {
  Course course(kHalfWindowS);
  course.follow(driving({0.0, 0.0, 0.0}, kSpeedMps, 1.0, kStart), kStart);
  course.advance(kStart, 0.01, 1.0);
  EXPECT_GT(course.at(after(1.0)).acceleration_world_mps2.norm(), 0.9);
  course.shift({2.0, 2.0, 1.0}, 0.4, after(1.0));
  for (const double t_s : {1.0, 1.1, 60.0}) {
    EXPECT_EQ(course.planned_at(after(t_s)).velocity_world_mps.norm(), 0.0) << t_s;
    EXPECT_EQ(course.planned_at(after(t_s)).acceleration_world_mps2.norm(), 0.0) << t_s;
    EXPECT_EQ(course.planned_at(after(t_s)).yaw_rate_radps, 0.0) << t_s;
  }
  course.hover({1.0, 1.0, 1.0}, 0.5, after(1.2));
  Setpoint stands;
  stands.position_world_m = {1.0, 1.0, 1.0};
  stands.yaw_rad = 0.5;
  expect_same(course.at(after(1.2)), stands);
  expect_same(course.at(after(9.0)), stands);
}

TEST(Course, FollowsPlansToTheirEndIfNoRoundIsSet) {
  Course course(kHalfWindowS);
  const HeldPlan plan = driving({0.0, 0.0, 0.0}, kSpeedMps, 1.0, kStart);
  course.follow(plan, kStart);
  for (const double t_s : {0.0, 0.1, 1.0, 3.9, 5.0}) {
    expect_same(course.planned_at(after(t_s)), point_at(plan, t_s));
  }
}

// A plan applies within its round. Beyond the round it applies only if the next plan has arrived,
// until that plan begins.
TEST(Course, FollowsAPlanUntilTheNextOneCanReplaceIt) {
  constexpr double kRoundS = 1.0;
  for (const double rate_radps : {0.8, -0.8}) {
    Course course(kHalfWindowS, kRoundS);
    const HeldPlan plan = driving({0.0, 0.0, 0.0}, kSpeedMps, rate_radps, kStart);
    course.follow(plan, kStart);
    course.advance(after(0.2), 0.01, 1.0);
    for (const double t_s : {0.1, 0.5, 0.9, 1.0}) {
      expect_same(course.planned_at(after(t_s)), point_at(plan, t_s));
    }
    const Setpoint straight_on = course.planned_at(after(1.4));
    const Setpoint turned = point_at(plan, kRoundS);
    EXPECT_TRUE(test::is_near(straight_on.position_world_m,
                              turned.position_world_m + 0.4 * turned.velocity_world_mps, 1e-12));
    EXPECT_NEAR(straight_on.yaw_rad, turned.yaw_rad, 1e-12);
    const HeldPlan next = driving({2.0, 2.0, 0.0}, kSpeedMps, 0.0, after(1.5));
    course.follow(next, after(0.8));
    expect_same(course.planned_at(after(1.4)), point_at(plan, 1.4));
    expect_same(course.planned_at(after(1.6)), point_at(next, 0.1));
  }
}

}  // namespace
}  // namespace vantage::drivers
