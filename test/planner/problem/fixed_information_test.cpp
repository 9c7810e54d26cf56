#include "planner/problem/fixed_information.hpp"

#include <gtest/gtest.h>

#include "planner/robot/trajectory_tools.hpp"
#include "planner/search/arvi.hpp"
#include "test/planner/robot/team_scenario.hpp"

namespace vantage::planner {
namespace {

// Two robots between two targets plan one after the other, so they go to different targets.
TEST(FixedInformation, SendsTheSecondRobotToTheOtherTarget) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.world.obstacles.clear();
  scenario.robots.resize(2);
  scenario.robots[0].start = {0.0, -0.6, 0.0};
  scenario.robots[1].start = {0.0, 0.6, kPi / 2};
  scenario.planner.exploration.landmarks_max = 0;
  scenario.planner.node_budget = 30'000;

  SearchProblem problem;
  problem.start_time = Time{std::chrono::seconds(1'700'000'000)};
  problem.start = scenario.robots[1].start;
  problem.controls = scenario.robots[1].primitives;
  problem.horizon_steps = 6;
  problem.sensors = {scenario.robots[1].sensor};
  for (const double x_m : {-2.0, 1.8}) {  // m; the second target is nearer to both robots
    problem.targets.push_back({scenario.estimator.target_model,
                               {Eigen::Vector2d(x_m, 0.0), Eigen::Matrix2d::Identity()}});
  }
  FixedTeammate teammate;
  teammate.sensor = scenario.robots[0].sensor;
  teammate.trajectory = hover_at({1.8, -0.3, 0.0}, 1.0, problem.start_time);
  const auto fixed = fixed_information(problem, {teammate});
  EXPECT_TRUE(fixed[0][5].isZero(0.0));
  EXPECT_GT(fixed[1][5].trace(), 0.0);

  ReducedValueIteration search({});
  const double alone_x_m = search.plan(problem, {}, Deadline::nodes(200'000)).poses.back().x_m;
  problem.fixed_information = fixed;
  const double after_x_m = search.plan(problem, {}, Deadline::nodes(200'000)).poses.back().x_m;
  EXPECT_GT(alone_x_m, 0.5);
  EXPECT_LT(after_x_m, -0.5);

  teammate.jammed = true;
  EXPECT_TRUE(fixed_information(problem, {teammate})[1][5].isZero(0.0));
}

// A teammate drives past a target and sees it only at the end of its third step.
TEST(FixedInformation, UsesTeammatePoseAtStepEnd) {
  const scenario::Scenario scenario = test::lab_scenario();
  SearchProblem problem;
  problem.start_time = Time{std::chrono::seconds(1'700'000'000)};
  problem.horizon_steps = 6;
  problem.step_s = 0.5;
  problem.targets = {{{models::TargetKind::kStatic, 2, 0.0},
                      {Eigen::Vector2d(1.5, 0.2), Eigen::Matrix2d::Identity()}}};
  FixedTeammate teammate;
  teammate.sensor = scenario.robots[0].sensor;
  teammate.sensor.range_max_m = 0.4;
  teammate.trajectory.start_time = problem.start_time;
  teammate.trajectory.segments = {{{1.0, 0.0}, 3.0, 0.0}};
  const auto fixed = fixed_information(problem, {teammate});
  for (std::size_t t = 0; t < 6; ++t) {
    EXPECT_EQ(fixed[0][t].trace() > 0.0, t == 2) << t;
  }
}

}  // namespace
}  // namespace vantage::planner
