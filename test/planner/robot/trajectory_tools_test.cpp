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

TEST(RestOf, IsTheSameMotionFromThereOn) {
  std::mt19937_64 rng(11);
  for (int i = 0; i < 200; ++i) {
    const models::Trajectory whole = winding_trajectory(rng);
    const double cut_s = std::uniform_real_distribution<double>(0.0, 6.0)(rng);
    const Time cut = whole.start_time + from_seconds(cut_s);
    const models::Trajectory rest = rest_of(whole, cut);
    for (double s = 0.0; s < 7.0; s += 0.083) {
      const auto a = models::at(whole, cut + from_seconds(s));
      const auto b = models::at(rest, cut + from_seconds(s));
      EXPECT_NEAR(a.world_from_body.x_m, b.world_from_body.x_m, 1e-5);
      EXPECT_NEAR(a.world_from_body.y_m, b.world_from_body.y_m, 1e-5);
      EXPECT_NEAR(wrap_to_pi(a.world_from_body.yaw_rad - b.world_from_body.yaw_rad), 0.0, 1e-5);
    }
  }
}

// Four horizons, and the stop of whoever needs longest for it, wherever in the team that is.
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
}

}  // namespace
}  // namespace vantage::planner
