#include "planner/robot/trajectory_tools.hpp"

#include <random>

#include <gtest/gtest.h>

namespace vantage::planner {
namespace {

models::Trajectory winding_trajectory(std::mt19937_64& rng) {
  models::Trajectory trajectory;
  trajectory.start_time = from_utime(1'700'000'000'000'000);
  trajectory.start = {0.3, -0.2, 0.7};
  trajectory.height_m = 1.5;
  std::uniform_real_distribution<double> speed(0.0, 3.0);
  std::uniform_real_distribution<double> yaw_rate(-3.0, 3.0);
  double last_mps = 0.0;
  for (int i = 0; i < 6; ++i) {
    last_mps = speed(rng);
    trajectory.segments.push_back({{last_mps, yaw_rate(rng)}, 0.5, 0.0});
  }
  for (const auto& segment : models::brake(last_mps, 2.0)) {
    trajectory.segments.push_back(segment);
  }
  return trajectory;
}

TEST(RemainderOf, HasThePosesOfTheTrajectoryAfterTheCut) {
  std::mt19937_64 rng(11);
  for (int i = 0; i < 200; ++i) {
    const models::Trajectory whole = winding_trajectory(rng);
    const double cut_s = std::uniform_real_distribution<double>(0.0, 6.0)(rng);
    const Time cut = whole.start_time + from_seconds(cut_s);
    const models::Trajectory rest = remainder_of(whole, cut);
    for (double s = 0.0; s < 7.0; s += 0.083) {
      const auto a = models::at(whole, cut + from_seconds(s));
      const auto b = models::at(rest, cut + from_seconds(s));
      EXPECT_NEAR(a.world_from_body.x_m, b.world_from_body.x_m, 1e-5);
      EXPECT_NEAR(a.world_from_body.y_m, b.world_from_body.y_m, 1e-5);
      EXPECT_NEAR(wrap_to_pi(a.world_from_body.yaw_rad - b.world_from_body.yaw_rad), 0.0, 1e-5);
    }
    EXPECT_EQ(rest.start_time, cut);
    EXPECT_EQ(rest.height_m, whole.height_m);
    for (const models::PlanSegment& segment : rest.segments) {
      EXPECT_GT(segment.duration_s, 0.0) << "past segments are removed";
    }
    EXPECT_EQ(rest.segments.empty(), models::end_time(whole) <= cut);
  }
}

// A cut at a segment boundary keeps the following segments unchanged. A cut while braking keeps the
// remaining braking, from the current speed.
TEST(RemainderOf, KeepsLaterSegmentsAndRemainingBraking) {
  models::Trajectory whole;
  whole.start_time = from_utime(1'700'000'000'000'000);
  whole.segments = {{{2.0, 0.0}, 0.5, 0.0}, {{1.0, 1.0}, 0.5, 0.0}, {{1.0, 0.0}, 0.5, 2.0}};
  EXPECT_EQ(remainder_of(whole, whole.start_time).segments.size(), 3U);
  const models::Trajectory two = remainder_of(whole, whole.start_time + from_seconds(0.5));
  ASSERT_EQ(two.segments.size(), 2U);
  EXPECT_EQ(two.segments[0].control, whole.segments[1].control);
  EXPECT_EQ(two.segments[0].duration_s, 0.5);
  const models::Trajectory braking = remainder_of(whole, whole.start_time + from_seconds(1.2));
  ASSERT_EQ(braking.segments.size(), 1U);
  EXPECT_NEAR(braking.segments[0].control.speed_mps, 0.6, 1e-12);
  EXPECT_NEAR(braking.segments[0].duration_s, 0.3, 1e-12);
  EXPECT_EQ(braking.segments[0].brake_mps2, 2.0);
  EXPECT_TRUE(remainder_of(whole, whole.start_time + from_seconds(1.5)).segments.empty());
}

// The stop begins at the current pose and speed and is straight. For a hovering vehicle it has no
// segment.
TEST(StopFrom, BrakesFromTheCurrentSpeed) {
  std::mt19937_64 rng(12);
  for (int i = 0; i < 50; ++i) {
    const models::Trajectory whole = winding_trajectory(rng);
    const Time when =
        whole.start_time + from_seconds(std::uniform_real_distribution<double>(0.0, 3.0)(rng));
    const models::TrajectoryPoint now = models::at(whole, when);
    const models::Trajectory stop = stop_from(whole, when, 1.6);
    EXPECT_EQ(stop.start, now.world_from_body);
    EXPECT_EQ(stop.start_time, when);
    EXPECT_EQ(stop.height_m, 1.5);
    const double speed_mps = now.control.speed_mps;
    EXPECT_EQ(models::end_time(stop), when + from_seconds(speed_mps / 1.6));
    const Eigen::Vector2d way_m =
        models::at(stop, Time::max()).world_from_body.position_m() - stop.start.position_m();
    const Eigen::Vector2d ahead(std::cos(stop.start.yaw_rad), std::sin(stop.start.yaw_rad));
    EXPECT_LT((way_m - speed_mps * speed_mps / 3.2 * ahead).norm(), 1e-9);
  }
  const models::Trajectory whole = winding_trajectory(rng);
  EXPECT_TRUE(stop_from(whole, models::end_time(whole), 1.6).segments.empty());
}

// A motion may last four horizons plus the longest stop of any robot of the team.
TEST(IsOfPlanLength, AllowsTheLongestStopOfTheTeam) {
  scenario::PlannerSpec planner;
  planner.horizon_steps = 3;
  planner.step_s = 0.5;
  scenario::RobotSpec quick;
  quick.limits.speed_max_mps = 1.0;
  quick.limits.brake_mps2 = 2.0;
  scenario::RobotSpec slow = quick;
  slow.limits.brake_mps2 = 0.25;
  const double most_s = 4 * 3 * 0.5 + 1.0 / 0.25;
  const auto is_taken = [&](double motion_s, const std::vector<scenario::RobotSpec>& robots) {
    models::Trajectory motion;
    motion.segments = {{{1.0, 0.0}, 1.0, 0.0}, {{1.0, 0.0}, motion_s - 1.0, 0.0}};
    return is_of_plan_length(motion, planner, robots);
  };
  for (const auto& robots :
       {std::vector{slow, quick}, std::vector{quick, slow}, std::vector{quick, slow, quick}}) {
    EXPECT_TRUE(is_taken(most_s - 1e-9, robots));
    EXPECT_FALSE(is_taken(most_s + 1e-9, robots));
  }
  EXPECT_FALSE(is_taken(most_s - 1e-9, {quick, quick}));
  const double quick_s = 4 * 3 * 0.5 + 1.0 / 2.0;
  EXPECT_TRUE(is_taken(quick_s - 1e-9, {quick, quick}));
  EXPECT_FALSE(is_taken(quick_s + 1e-9, {quick, quick}));
}

TEST(IsOfPlanLength, AllowsTheSegmentsOfFourHorizons) {
  scenario::PlannerSpec planner;
  planner.horizon_steps = 3;
  models::Trajectory motion;
  motion.segments.assign(12, {{1.0, 0.0}, 0.1, 0.0});
  EXPECT_TRUE(is_of_plan_length(motion, planner, {scenario::RobotSpec{}}));
  motion.segments.push_back(motion.segments.back());
  EXPECT_FALSE(is_of_plan_length(motion, planner, {scenario::RobotSpec{}}));
}

}  // namespace
}  // namespace vantage::planner
