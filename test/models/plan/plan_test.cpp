#include "models/plan/plan.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "test/support/allocation_counter.hpp"
#include "test/support/near.hpp"
#include "test/support/random.hpp"

namespace vantage::models {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr double kBrake_mps2 = 2.0;

// Returns a trajectory of up to five primitives; every second one, on average, ends with a stop.
Trajectory random_trajectory(test::Random& random, double half_side_m) {
  Trajectory trajectory;
  trajectory.start_time = kStart + from_seconds(random.uniform(-2.0, 2.0));
  trajectory.start = random.pose2(half_side_m);
  trajectory.height_m = random.coin() ? 1.0 : 1.3;
  double speed_mps = 0.0;
  const int segments = random.integer(0, 5);
  for (int i = 0; i < segments; ++i) {
    speed_mps = random.coin() ? 1.0 : 3.0;
    trajectory.segments.push_back({{speed_mps, 1.0 * random.integer(-3, 3)}, 0.5, 0.0});
  }
  if (random.coin()) {
    for (const PlanSegment& segment : brake(speed_mps, kBrake_mps2)) {
      trajectory.segments.push_back(segment);
    }
  }
  return trajectory;
}

Eigen::Vector3d position_m(const Trajectory& trajectory, Time time) {
  const Pose2 pose = at(trajectory, time).world_from_body;
  return {pose.x_m, pose.y_m, trajectory.height_m};
}

TEST(TrajectoryAt, FollowsTheSegmentsAndThenHovers) {
  Trajectory trajectory{
      kStart, {1.0, 2.0, 0.5}, 1.0, {{{3.0, 1.0}, 0.5, 0.0}, {{1.0, -3.0}, 0.5, 0.0}}};
  const Pose2 middle = step_unicycle(trajectory.start, {3.0, 1.0}, 0.5);
  const Pose2 end = step_unicycle(middle, {1.0, -3.0}, 0.5);
  EXPECT_EQ(at(trajectory, kStart).world_from_body, trajectory.start);
  EXPECT_EQ(at(trajectory, kStart).control, (UnicycleControl{3.0, 1.0}));
  EXPECT_EQ(at(trajectory, kStart + from_seconds(0.2)).world_from_body,
            step_unicycle(trajectory.start, {3.0, 1.0}, 0.2));
  EXPECT_EQ(at(trajectory, kStart + from_seconds(0.5)).world_from_body, middle);
  EXPECT_EQ(at(trajectory, kStart + from_seconds(0.5)).control, (UnicycleControl{1.0, -3.0}));
  EXPECT_EQ(at(trajectory, kStart + from_seconds(1.0)).world_from_body, end);
  EXPECT_EQ(at(trajectory, kStart + from_seconds(1.0)).control, UnicycleControl{});
  EXPECT_EQ(at(trajectory, kStart + from_seconds(1e6)).world_from_body, end);
}

TEST(TrajectoryAt, HoversAtStartBeforeStartTime) {
  const Trajectory trajectory{kStart, {1.0, 2.0, 0.5}, 1.0, {{{3.0, 1.0}, 0.5, 0.0}}};
  const TrajectoryPoint point = at(trajectory, kStart - Duration{1});
  EXPECT_EQ(point.world_from_body, trajectory.start);
  EXPECT_EQ(point.control, UnicycleControl{});
}

TEST(TrajectoryAt, HoversPermanentlyWithoutSegments) {
  const Trajectory trajectory{kStart, {1.0, 2.0, 0.5}, 1.0, {}};
  EXPECT_EQ(end_time(trajectory), kStart);
  EXPECT_EQ(at(trajectory, kStart + from_seconds(3.0)).world_from_body, trajectory.start);
}

TEST(TrajectoryAt, IsContinuousAndWithinItsControlSpeed) {
  test::Random random(81);
  for (int i = 0; i < 300; ++i) {
    const Trajectory trajectory = random_trajectory(random, 3.0);
    for (Time t = kStart - from_seconds(2.5); t < end_time(trajectory) + from_seconds(0.5);
         t += Duration{10'000}) {
      const double moved_m =
          (position_m(trajectory, t + Duration{10'000}) - position_m(trajectory, t)).norm();
      ASSERT_LE(moved_m, 0.01 * 3.0 + 1e-9);
      const double speed_mps = at(trajectory, t).control.speed_mps;
      if (speed_mps == at(trajectory, t + Duration{10'000}).control.speed_mps) {
        ASSERT_NEAR(moved_m, 0.01 * speed_mps, 1e-4);
      }
    }
  }
}

TEST(EndTime, IsTheTimeOfTheStop) {
  test::Random random(82);
  for (int i = 0; i < 300; ++i) {
    const Trajectory trajectory = random_trajectory(random, 3.0);
    const Time end = end_time(trajectory);
    ASSERT_EQ(at(trajectory, end).control, UnicycleControl{});
    if (!trajectory.segments.empty()) {
      ASSERT_GT(at(trajectory, end - Duration{2}).control.speed_mps, 0.0);
    }
  }
}

TEST(Brake, StopsAfterSquaredSpeedOverTwiceTheDeceleration) {
  const Trajectory stop{kStart, {0.0, 0.0, kPi / 2}, 1.0, brake(3.0, 2.0)};
  ASSERT_EQ(stop.segments.size(), 1u);
  EXPECT_DOUBLE_EQ(stop.segments[0].duration_s, 1.5);
  EXPECT_TRUE(test::is_near(position_m(stop, end_time(stop)), Eigen::Vector3d(0, 2.25, 1), 1e-12));
  const TrajectoryPoint halfway = at(stop, kStart + from_seconds(0.75));
  EXPECT_NEAR(halfway.control.speed_mps, 1.5, 1e-12);
  EXPECT_EQ(halfway.control.yaw_rate_radps, 0.0);
  EXPECT_NEAR(halfway.world_from_body.y_m, 1.6875, 1e-12);
  EXPECT_EQ(halfway.world_from_body.yaw_rad, kPi / 2);
}

TEST(Brake, StopsBackwardsToo) {
  const Trajectory stop{kStart, {}, 1.0, brake(-3.0, 2.0)};
  EXPECT_NEAR(position_m(stop, end_time(stop)).x(), -2.25, 1e-12);
  EXPECT_NEAR(at(stop, kStart + from_seconds(0.75)).control.speed_mps, -1.5, 1e-12);
}

// The bound uses the speeds without braking, forwards and in reverse.
TEST(LengthAtMost, BoundsForwardAndReverseDistance) {
  test::Random random(84);
  for (int i = 0; i < 300; ++i) {
    Trajectory trajectory = random_trajectory(random, 2.0);
    for (PlanSegment& segment : trajectory.segments) {
      segment.control.speed_mps *= random.coin() ? 1.0 : -1.0;
    }
    double expected_m = 0.0;
    double length_m = 0.0;
    Eigen::Vector3d last_m = position_m(trajectory, trajectory.start_time);
    for (const PlanSegment& segment : trajectory.segments) {
      expected_m += std::abs(segment.control.speed_mps) * segment.duration_s;
    }
    for (Time t = trajectory.start_time; t < end_time(trajectory); t += from_seconds(0.01)) {
      length_m += (position_m(trajectory, t) - last_m).norm();
      last_m = position_m(trajectory, t);
    }
    EXPECT_NEAR(length_at_most_m(trajectory), expected_m, 1e-12);
    EXPECT_GE(length_at_most_m(trajectory), length_m - 1e-9);
  }
}

TEST(Brake, IsEmptyAtRest) { EXPECT_TRUE(brake(0.0, 2.0).empty()); }

TEST(KeepsSeparation, AgreesWithDenseSampling) {
  test::Random random(83);
  constexpr double kSeparation_m = 0.6;
  int kept = 0;
  int decided = 0;
  for (int i = 0; i < 4000; ++i) {
    const Trajectory a = random_trajectory(random, 1.0);
    const Trajectory b = random_trajectory(random, 1.0);
    const Time from = kStart + from_seconds(random.uniform(-3.0, 5.0));
    double least_m = INFINITY;
    const Time last = std::max({from, end_time(a), end_time(b)});
    for (Time t = from; t < last + Duration{5'000}; t += Duration{5'000}) {
      least_m = std::min(least_m, (position_m(a, t) - position_m(b, t)).norm());
    }
    const bool keeps = keeps_separation(a, b, from, kSeparation_m);
    ASSERT_EQ(keeps, keeps_separation(b, a, from, kSeparation_m));
    if (least_m < kSeparation_m) {
      ASSERT_FALSE(keeps) << "sampled " << least_m;
    }
    // The sampled distance is too large by at most 6 m/s · 2.5 ms = 15 mm. The check itself is
    // conservative by less than a millimetre.
    if (least_m > kSeparation_m + 0.018) {
      ASSERT_TRUE(keeps) << "sampled " << least_m;
      ++decided;
    }
    kept += keeps ? 1 : 0;
  }
  EXPECT_GT(kept, 1000);
  EXPECT_LT(kept, 3600);
  EXPECT_GT(decided, 900);
}

TEST(KeepsSeparation, IsExactForLongSegments) {
  test::Random random(84);
  for (int i = 0; i < 2000; ++i) {
    const Trajectory a = random_trajectory(random, 1.0);
    const Trajectory b = random_trajectory(random, 1.0);
    if (keeps_separation(a, b, kStart, 0.6, 10.0)) {
      ASSERT_TRUE(keeps_separation(a, b, kStart, 0.599, 0.01));
    }
  }
}

TEST(KeepsSeparation, DetectsASwapBetweenTwoSamples) {
  const Trajectory a{kStart, {-1.0, 0.0, 0.0}, 1.0, {{{3.0, 0.0}, 0.7, 0.0}}};
  const Trajectory b{kStart, {1.0, 0.0, kPi}, 1.0, {{{3.0, 0.0}, 0.7, 0.0}}};
  EXPECT_FALSE(keeps_separation(a, b, kStart, 0.01, 1.0));
}

TEST(KeepsSeparation, IncludesTheHeightDifference) {
  const Trajectory low{kStart, {}, 1.0, {}};
  const Trajectory high{kStart, {}, 1.6, {}};
  EXPECT_TRUE(keeps_separation(low, high, kStart, 0.6 - 1e-12));
  EXPECT_FALSE(keeps_separation(low, high, kStart, 0.6 + 1e-9));
}

TEST(KeepsSeparation, IgnoresHeightIfOnlyHorizontalDistancesCount) {
  test::Random random(87);
  int differ = 0;
  for (int i = 0; i < 2000; ++i) {
    const Trajectory a = random_trajectory(random, 1.0);
    Trajectory b = random_trajectory(random, 2.0);
    b.height_m += 1.0;
    const bool in_space = keeps_separation(a, b, kStart, 0.6);
    const bool from_above = keeps_separation(a, b, kStart, 0.6, kPlanPiece_s, true);
    b.height_m = a.height_m;
    ASSERT_EQ(from_above, keeps_separation(a, b, kStart, 0.6));
    differ += in_space != from_above ? 1 : 0;
  }
  EXPECT_GT(differ, 100);
}

TEST(KeepsSeparation, CountsHoverBeforeStartAndAfterEnd) {
  const Trajectory passes{kStart, {-3.0, 0.0, 0.0}, 1.0, {{{3.0, 0.0}, 2.0, 0.0}}};
  const Trajectory waits{
      kStart + from_seconds(3600.0), {0.0, 0.1, 0.0}, 1.0, {{{3.0, 0.0}, 2.0, 0.0}}};
  EXPECT_FALSE(keeps_separation(passes, waits, kStart, 0.5));
  // An hour later, `joins` drives past the hover position of `passes`; with a yaw of −0.3 rad it
  // drives over this position.
  Trajectory joins = waits;
  joins.start.y_m = 0.6;
  EXPECT_TRUE(keeps_separation(passes, joins, kStart, 0.5));
  joins.start.yaw_rad = -0.3;
  EXPECT_FALSE(keeps_separation(passes, joins, kStart, 0.5));
  EXPECT_TRUE(
      keeps_separation(passes, joins, kStart + from_seconds(3602.0), 0.5) ==
      ((position_m(joins, end_time(joins)) - position_m(passes, end_time(passes))).norm() > 0.5));
}

TEST(KeepsSeparation, IgnoresPastMotion) {
  const Trajectory a{kStart, {-1.0, 0.0, 0.0}, 1.0, {{{3.0, 0.0}, 2.0, 0.0}}};
  const Trajectory b{kStart, {}, 1.0, {}};
  EXPECT_FALSE(keeps_separation(a, b, kStart, 0.5));
  EXPECT_TRUE(keeps_separation(a, b, kStart + from_seconds(0.6), 0.5));
}

World lab() { return {{{-4.0, -4.0}, {4.0, 4.0}}, 3.0, {{{{-1.0, -0.5}, {0.5, 0.7}}, 1.0}}, {}}; }

TEST(IsClear, AgreesWithDenseSampling) {
  test::Random random(85);
  constexpr double kRadius_m = 0.3;
  const World world = lab();
  int clear = 0;
  for (int i = 0; i < 4000; ++i) {
    const Trajectory trajectory = random_trajectory(random, 3.5);
    const Time from = kStart + from_seconds(random.uniform(-3.0, 3.0));
    double least_m = INFINITY;
    const Time last = std::max(from, end_time(trajectory));
    for (Time t = from; t < last + Duration{5'000}; t += Duration{5'000}) {
      least_m = std::min(least_m, clearance_m(world, position_m(trajectory, t).head<2>()));
    }
    const bool is = is_clear(world, trajectory, from, kRadius_m);
    if (least_m <= kRadius_m) {
      ASSERT_FALSE(is) << "sampled " << least_m;
    }
    if (least_m > kRadius_m + 0.01) {
      ASSERT_TRUE(is) << "sampled " << least_m;
    }
    clear += is ? 1 : 0;
  }
  EXPECT_GT(clear, 500);
  EXPECT_LT(clear, 3500);
}

TEST(IsClear, DetectsTheBulgeOfAnArc) {
  const World world{{{-5.0, -5.0}, {5.0, 1.4}}, 3.0, {}, {}};
  // Half a circle of radius 1 that rises to y = 1 between ends at y = 0.
  const Trajectory arc{kStart, {1.0, 0.0, kPi / 2}, 1.0, {{{1.0, 1.0}, kPi, 0.0}}};
  EXPECT_FALSE(is_clear(world, arc, kStart, 0.41, 100.0));
  EXPECT_TRUE(is_clear(world, arc, kStart, 0.39, 100.0));
}

TEST(IsClear, ChecksHoverWithoutSegments) {
  EXPECT_TRUE(is_clear(lab(), {kStart, {2.0, 2.0, 0.0}, 1.0, {}}, kStart, 0.3));
  EXPECT_FALSE(is_clear(lab(), {kStart, {0.0, 0.0, 0.0}, 1.0, {}}, kStart, 0.3));
  EXPECT_FALSE(is_clear(lab(), {kStart, {3.8, 2.0, 0.0}, 1.0, {}}, kStart, 0.3));
}

TEST(PlanChecks, AllocateNothing) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "allocations are not counted under a sanitizer";
  }
  test::Random random(86);
  const Trajectory a = random_trajectory(random, 2.0);
  const Trajectory b = random_trajectory(random, 2.0);
  const World world = lab();
  const test::AllocationCounter allocations;
  const bool kept = keeps_separation(a, b, kStart, 0.1);
  const bool clear = is_clear(world, a, kStart, 0.1);
  const TrajectoryPoint point = at(a, kStart);
  EXPECT_EQ(allocations.count(), 0u);
  EXPECT_TRUE((kept || clear) || point.world_from_body.x_m < 100.0);
}

}  // namespace
}  // namespace vantage::models
