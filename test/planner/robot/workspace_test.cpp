#include "planner/robot/workspace.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/robot/trajectory_tools.hpp"
#include "test/planner/robot/team_scenario.hpp"
#include "test/support/allocation_counter.hpp"

namespace vantage::planner {
namespace {

TEST(Workspace, FindsRobotsByName) {
  const Workspace workspace(test::lab_scenario());
  EXPECT_EQ(workspace.index_of("Q1"), 0U);
  EXPECT_EQ(workspace.index_of("Q3"), 2U);
  EXPECT_EQ(workspace.index_of("Q4"), std::nullopt);
}

// Cells measure 5 cm, or more if the longer side would have more than 500 of them.
TEST(Workspace, LimitsFieldResolution) {
  const auto resolution_m = [](double width_m, double depth_m) {
    scenario::Scenario scenario = test::lab_scenario();
    scenario.world.obstacles.clear();
    scenario.world.bounds = {{-3.0, 1.0}, {-3.0 + width_m, 1.0 + depth_m}};
    return Workspace(scenario).field().geometry().resolution_m;
  };
  EXPECT_NEAR(resolution_m(8.0, 4.0), 0.05, 1e-12);
  EXPECT_NEAR(resolution_m(24.0, 4.0), 0.05, 1e-12);
  EXPECT_NEAR(resolution_m(100.0, 10.0), 0.2, 1e-12);
  EXPECT_NEAR(resolution_m(10.0, 100.0), 0.2, 1e-12);
}

// A search has memory for each target, its mixture components and the landmarks. For each robot it
// has memory for a plan, its ground position and its flight position. Larger problems are refused.
TEST(Workspace, HasCapacityForAnyRound) {
  scenario::Scenario scenario = test::lab_scenario();
  for (const auto& [landmarks_max, has_parts] :
       {std::pair{12, false}, std::pair{12, true}, std::pair{-5, false}}) {
    scenario.planner.exploration.landmarks_max = landmarks_max;
    scenario.estimator.samples = has_parts;
    Workspace workspace(scenario);
    const std::size_t targets = 5 + (has_parts ? 35U : 0U) + (landmarks_max > 0 ? 12U : 0U);
    SearchProblem problem;
    problem.horizon_steps = scenario.planner.horizon_steps;
    problem.controls = models::lab_primitives();
    problem.start.x_m = 100.0;
    problem.sensors.emplace_back();
    problem.targets.assign(targets, {{models::TargetKind::kStatic, 2, 0.0},
                                     {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()}});
    problem.teammates.resize(9 + kBodiesMax);
    const Deadline deadline = Deadline::nodes(50);
    const auto plan = [&] {
      workspace.search().plan(problem, deadline);
      workspace.make_search(1)->plan(problem, deadline);
      workspace.reduced().plan(problem, {}, deadline);
    };
    EXPECT_NO_THROW(plan()) << landmarks_max << has_parts;
    const SearchProblem right = problem;
    problem.targets.push_back(problem.targets.back());
    EXPECT_THROW(workspace.search().plan(problem, deadline), UsageError) << "a target too many";
    EXPECT_THROW(workspace.reduced().plan(problem, {}, deadline), UsageError);
    problem = right;
    problem.teammates.emplace_back();
    EXPECT_THROW(workspace.search().plan(problem, deadline), UsageError) << "a teammate too many";
    problem = right;
    ++problem.horizon_steps;
    EXPECT_THROW(workspace.search().plan(problem, deadline), UsageError) << "a step too many";
  }
}

// The longest plan that is accepted starts four horizons ahead, drives for four horizons and then
// brakes.
TEST(Workspace, AllocatesNothingForTheLongestAcceptedPlans) {
  if (!vantage::test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the allocation counter is inert under sanitizers";
  }
  const scenario::Scenario scenario = test::lab_scenario();
  const scenario::PlannerSpec& planner = scenario.planner;
  const auto& limits = scenario.robots.front().limits;
  const double horizons_s = kPlanHorizonsMax * planner.horizon_steps * planner.step_s;
  Workspace workspace(scenario);
  SearchProblem problem;
  problem.horizon_steps = planner.horizon_steps;
  problem.step_s = planner.step_s;
  problem.brake_mps2 = limits.brake_mps2;
  problem.start_speed_mps = limits.speed_max_mps;
  problem.controls = models::lab_primitives();
  problem.start.x_m = 100.0;
  problem.sensors.emplace_back();
  problem.targets.assign(1, {{models::TargetKind::kStatic, 2, 0.0},
                             {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()}});
  const auto search = workspace.make_search(0);
  search->plan(problem, Deadline::nodes(50));

  models::Trajectory longest;
  longest.start_time = problem.start_time + from_seconds(horizons_s);
  longest.segments = {
      {{limits.speed_max_mps, 0.0}, horizons_s, 0.0},
      {{limits.speed_max_mps, 0.0}, limits.speed_max_mps / limits.brake_mps2, limits.brake_mps2}};
  ASSERT_TRUE(is_of_plan_length(longest, planner, scenario.robots));
  problem.teammates.assign(9 + kBodiesMax, longest);
  const vantage::test::AllocationCounter allocations;
  search->plan(problem, Deadline::nodes(50));
  EXPECT_EQ(allocations.count(), 0U);
}

TEST(PartsMax, IsSevenPerTargetUpToItsLimit) {
  scenario::Scenario scenario = test::lab_scenario();
  EXPECT_EQ(components_max(scenario), 0U);
  for (const auto& [targets, parts] :
       {std::pair{0, 0}, std::pair{1, 7}, std::pair{36, 252}, std::pair{37, 256}}) {
    scenario.targets.resize(static_cast<std::size_t>(targets));
    scenario.estimator.samples = true;
    EXPECT_EQ(components_max(scenario), static_cast<std::size_t>(parts));
    scenario.estimator.samples = false;
    for (scenario::RobotSpec& robot : scenario.robots) {
      robot.detection.detects_ids = false;
      EXPECT_EQ(components_max(scenario), static_cast<std::size_t>(parts)) << robot.name;
      robot.detection.detects_ids = true;
    }
  }
}

// The workspace creates its own search once; make_search() returns a separate one.
TEST(Workspace, CreatesItsOwnSearchOnce) {
  Workspace workspace(test::lab_scenario());
  workspace.prefault();  // no search exists yet
  Search& search = workspace.search();
  EXPECT_EQ(&workspace.search(), &search);
  EXPECT_NE(workspace.make_search(0).get(), &search);
  ReducedValueIteration& reduced = workspace.reduced();
  EXPECT_EQ(&workspace.reduced(), &reduced);
  workspace.prefault();
}

// The first completed pass uses the epsilon and delta of the scenario.
TEST(Workspace, UsesScenarioSearchOptions) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.epsilon_initial = 0.8;
  scenario.planner.delta_initial_m = 0.6;
  SearchProblem problem;
  problem.horizon_steps = 3;
  problem.controls = models::lab_primitives();
  problem.sensors.emplace_back();
  problem.targets = {{{models::TargetKind::kRandomWalk, 2, 0.1},
                      {Eigen::Vector2d(1.0, 2.0), Eigen::Matrix2d::Identity()}}};
  Workspace workspace(scenario);
  const SearchResult& result = workspace.search().plan(problem, Deadline::never());
  ASSERT_TRUE(result.found);
  std::vector<PassReport> finite;
  for (const PassReport& pass : result.history) {
    if (std::isfinite(pass.epsilon)) {
      finite.push_back(pass);
    }
  }
  ASSERT_FALSE(finite.empty());
  EXPECT_EQ(finite.front().epsilon, 0.8);
  EXPECT_EQ(finite.front().delta_m, 0.6);
}

// The grid has the given time stamps and the world's free cells. This applies to any part of the
// grid and any previous content. Observations expire after the memory time.
TEST(Workspace, ReturnsTheRequestedPartOfTheGrid) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.estimator.grid_memory_s = 10.0;
  Workspace workspace(scenario);
  const auto whole = models::GridGeometry::covering(scenario.world.bounds, 0.25);
  const auto part = whole.window({2.0, 1.0}, 0.6);
  ASSERT_LT(part.size(), whole.size());
  const Time now = from_utime(1'700'000'000'000'000);
  for (int i = 0; i < 3; ++i) {
    for (const models::GridGeometry& geometry : {whole, part, part}) {
      std::vector<std::int64_t> stamps(static_cast<std::size_t>(geometry.size()),
                                       models::VisibilityGrid::kNeverSeen);
      stamps[static_cast<std::size_t>(i)] = to_utime(now - from_seconds(9.9));
      stamps[static_cast<std::size_t>(i + 1)] = to_utime(now - from_seconds(10.1));
      const models::VisibilityGrid& ground = workspace.ground(geometry, stamps);
      EXPECT_EQ(ground.geometry(), geometry);
      EXPECT_EQ(ground.last_seen_utime(), stamps);
      EXPECT_TRUE(ground.is_explored(i, now));
      EXPECT_FALSE(ground.is_explored(i + 1, now));
      for (int cell = 0; cell < geometry.size(); ++cell) {
        const Eigen::Vector2d at_m = geometry.centre_m(cell);
        EXPECT_EQ(ground.is_free(cell), models::clearance_m(scenario.world, at_m) > 0.0) << cell;
      }
    }
  }
}

}  // namespace
}  // namespace vantage::planner
