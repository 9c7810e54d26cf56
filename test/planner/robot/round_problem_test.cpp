#include "planner/robot/round_problem.hpp"

#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "planner/robot/trajectory_tools.hpp"
#include "test/planner/robot/team_scenario.hpp"

namespace vantage::planner {
namespace {

// The noise of a target grows with the number of steps for which it is unseen. These steps are
// counted until the plan begins, not only until the time of the belief.
TEST(ProblemOfRound, CountsUnseenStepsUntilPlanBegins) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.estimator.target_model = {models::TargetKind::kGrowingUncertainty, 2, 0.1};
  scenario.planner.step_s = 0.5;
  PlanInputs inputs = test::first_inputs(scenario, 0, 1);
  inputs.belief->stamp.time = inputs.slot.activation - from_seconds(1.2);
  inputs.belief->targets.resize(2);
  inputs.belief->targets[0].last_seen = inputs.belief->stamp.time - from_seconds(0.9);
  inputs.belief->targets[1].last_seen = inputs.belief->stamp.time;
  Workspace workspace(scenario);
  models::Trajectory committed;
  committed.start_time = inputs.slot.activation;
  committed.start = scenario.robots[0].start;
  const RoundProblem round = problem_of_round(workspace, 0, inputs, committed, {});
  ASSERT_GE(round.search.targets.size(), 2U);
  const double whole_steps[] = {4.0, 2.0};  // unseen for 2.1 s and for 1.2 s
  for (std::size_t m = 0; m < 2; ++m) {
    EXPECT_EQ(round.search.targets[m].model.kind, models::TargetKind::kRandomWalk);
    EXPECT_NEAR(round.search.targets[m].model.q, 0.1 * whole_steps[m] / 0.5, 1e-12) << m;
  }
}

// The terminal value is a function of the inputs. With communication, teammates take some stops.
TEST(ProblemOfRound, UsesTheTerminalValueOfTheTour) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.exploration.landmarks_max = 0;
  const auto stops_of = [&](std::size_t robot) {
    const PlanInputs inputs = test::first_inputs(scenario, robot, 1);
    Workspace workspace(scenario);
    models::Trajectory committed;
    committed.start_time = inputs.slot.activation;
    committed.start = scenario.robots[robot].start;
    const RoundProblem round = problem_of_round(workspace, robot, inputs, committed, {});
    EXPECT_NO_THROW(require_valid(round.search));
    std::vector<int> targets;
    for (const TerminalValue::Stop& stop : round.search.terminal.stops()) {
      targets.push_back(stop.target);
    }
    return targets;
  };
  EXPECT_TRUE(stops_of(0).empty()) << "off by default";
  scenario.planner.tour.horizon_s = 40.0;
  const std::vector<int> alone = stops_of(0);
  EXPECT_EQ(alone.size(), 5U);
  EXPECT_EQ(stops_of(0), alone);
  scenario.network.communication_range_m = 10.0;
  for (std::size_t robot = 0; robot < 3; ++robot) {
    EXPECT_LT(stops_of(robot).size(), 5U) << robot;
  }
}

/// Fixture with a scenario in which the beliefs of unseen targets are mixtures of several
/// Gaussians.
class PlansWithMixtures : public ::testing::Test {
 protected:
  PlansWithMixtures() {
    scenario_.estimator.target_model = {models::TargetKind::kDoubleIntegrator, 2, 0.01};
    scenario_.estimator.samples = true;
    inputs_ = test::first_inputs(scenario_, 0);
    models::RobotBelief belief;
    belief.stamp = {inputs_.slot.begin, 7, 0};
    belief.robot = "Q1";
    belief.step = 3;
    for (int id = 0; id < 5; ++id) {
      belief.targets.push_back({id, *models::to_information(gaussian(id, 0.0)), belief.stamp.time});
    }
    inputs_.belief = belief;
    inputs_.mixture = models::BeliefMixture{belief.stamp, "Q1", 3, {}};
  }

  static models::Gaussian gaussian(double x_m, double y_m) {
    return {Eigen::Vector4d(x_m, y_m, 0.1, 0.0), 0.3 * Eigen::Matrix4d::Identity()};
  }
  void add(int id, const std::vector<double>& weights) {
    models::TargetMixture target{id, 1.0, {}};
    for (const double weight : weights) {
      const double y_m = 1.0 + static_cast<double>(target.components.size());
      target.components.push_back({weight, gaussian(id, y_m)});
    }
    inputs_.mixture->targets.push_back(target);
  }
  /// Returns the mean positions of the problem's targets, m, one per column, sorted by y.
  [[nodiscard]] std::vector<Eigen::Vector2d> places_m() const {
    Workspace workspace(scenario_);
    models::Trajectory committed;
    committed.start_time = inputs_.slot.activation;
    committed.start = scenario_.robots[0].start;
    const RoundProblem round = problem_of_round(workspace, 0, inputs_, committed, {});
    require_valid(round.search);
    std::vector<Eigen::Vector2d> places_m;
    for (const SearchTarget& target : round.search.targets) {
      places_m.emplace_back(target.prior.mean.head<2>());
    }
    return places_m;
  }
  [[nodiscard]] double ahead_m() const {  // m; distance at 0.1 m/s until the plan begins
    return 0.1 * to_seconds(inputs_.slot.activation - inputs_.belief->stamp.time);
  }

  scenario::Scenario scenario_ = test::lab_scenario();
  PlanInputs inputs_;
};

// The test scenario has static targets. The robot has observed one cell of the grid.
TEST(ProblemOfRound, ExploresUntilTargetsAreFoundIfConfigured) {
  scenario::Scenario scenario = test::lab_scenario();
  PlanInputs inputs = test::first_inputs(scenario, 0, 1);
  const models::VisibilityGrid grid(scenario.world, scenario.estimator.grid_resolution_m,
                                    scenario.estimator.grid_memory_s);
  inputs.belief->grid = grid.geometry();
  inputs.belief->last_seen_utime = grid.last_seen_utime();
  inputs.belief->last_seen_utime[0] = to_utime(inputs.belief->stamp.time);  // explored cell
  const auto landmarks = [&] {
    Workspace workspace(scenario);
    models::Trajectory committed;
    committed.start_time = inputs.slot.activation;
    committed.start = scenario.robots[0].start;
    const RoundProblem round = problem_of_round(workspace, 0, inputs, committed, {});
    EXPECT_EQ(round.unusable_beliefs, 0);
    return round.search.targets.size() - inputs.belief->targets.size();
  };
  ASSERT_EQ(inputs.belief->targets.size(), scenario.targets.size());
  const std::size_t all = landmarks();
  EXPECT_GT(all, 0U);
  scenario.planner.exploration.until_found = true;
  EXPECT_EQ(landmarks(), 0U);
  inputs.belief->targets.pop_back();
  EXPECT_EQ(landmarks(), all);
  scenario.planner.exploration.until_found = false;
  EXPECT_EQ(landmarks(), all);
}

// All numbers of the scenario differ. The problem must use those of the requested robot, and begin
// on its committed motion.
TEST(ProblemOfRound, MatchesScenario) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.horizon_steps = 7;
  scenario.planner.step_s = 0.4;
  scenario.planner.separation_m = 0.7;
  scenario.planner.tracking_tolerance_m = 0.15;
  scenario.planner.obstacle_margin_m = 0.12;
  scenario.robots[1].limits.radius_m = 0.31;
  scenario.robots[1].limits.brake_mps2 = 1.7;
  scenario.robots[1].sensor.range_max_m = 1.9;
  scenario.robots[1].primitives = models::standard_primitives();
  PlanInputs inputs = test::first_inputs(scenario, 1);
  Workspace workspace(scenario);
  models::Trajectory committed;
  committed.start_time = inputs.slot.activation;
  committed.start = {0.5, -0.4, 2.0};
  committed.segments = {{{0.8, 1.0}, 0.4, 0.0}, {{0.3, 0.0}, 1.0, 0.0}};
  const SearchProblem problem = problem_of_round(workspace, 1, inputs, committed, {}).search;
  EXPECT_EQ(problem.start_time, inputs.slot.activation);
  EXPECT_EQ(problem.start, committed.start);
  EXPECT_EQ(problem.start_speed_mps, 0.8);
  EXPECT_EQ(problem.height_m, 1.5);
  EXPECT_EQ(problem.controls, models::standard_primitives());
  EXPECT_EQ(problem.horizon_steps, 7);
  EXPECT_EQ(problem.step_s, 0.4);
  ASSERT_EQ(problem.sensors.size(), 1U);
  EXPECT_EQ(problem.sensors[0].range_max_m, 1.9);
  EXPECT_EQ(problem.cost, CostKind::kLogDet);
  EXPECT_EQ(problem.world, &workspace.scenario().world);
  EXPECT_EQ(problem.field, &workspace.field());
  EXPECT_NEAR(problem.clearance_m, 0.43, 1e-12);
  EXPECT_NEAR(problem.separation_m, 1.0, 1e-12);
  EXPECT_FALSE(problem.separation_from_above);
  EXPECT_EQ(problem.brake_mps2, 1.7);
  EXPECT_TRUE(problem.targets.empty()) << "no belief was received";
  scenario.planner.separation_from_above = true;
  Workspace from_above(scenario);
  EXPECT_TRUE(problem_of_round(from_above, 1, inputs, committed, {}).search.separation_from_above);
}

// Without motion capture, the clearance to obstacles grows by 3σ of the pose, but by no more than
// the start allows.
TEST(ProblemOfRound, KeepsThreeSigmasFromObstaclesWithoutMocap) {
  struct Row {
    double sigma_m;
    double from_wall_m;
    double clearance_m;
  };
  const scenario::Scenario scenario = test::lab_scenario();
  const double usual_m = scenario.robots[0].limits.radius_m + scenario.planner.obstacle_margin_m;
  for (const Row& row : {Row{0.0, 2.0, usual_m}, Row{0.1, 2.0, usual_m + 0.3},
                         Row{0.1, usual_m + 0.11, usual_m + 0.1},  // start 0.11 m beyond usual_m
                         Row{0.1, usual_m - 0.1, usual_m}}) {
    PlanInputs inputs = test::first_inputs(scenario, 0);
    if (row.sigma_m > 0.0) {
      models::PoseEstimate& pose = inputs.poses["Q1"];
      pose.covariance = Eigen::Matrix3d::Identity() * 1e-6;
      pose.covariance(1, 1) = row.sigma_m * row.sigma_m;
    }
    Workspace workspace(scenario);
    models::Trajectory committed;
    committed.start_time = inputs.slot.activation;
    committed.start = {row.from_wall_m - 4.0, -0.8, 0.0};
    const SearchProblem problem = problem_of_round(workspace, 0, inputs, committed, {}).search;
    EXPECT_NEAR(problem.clearance_m, row.clearance_m, 1e-9) << row.sigma_m << row.from_wall_m;
  }
}

// The seed differs for each robot, round and scenario, and is reproducible.
TEST(ProblemOfRound, HasADifferentSeedForEachRobotRoundAndScenario) {
  scenario::Scenario scenario = test::lab_scenario();
  std::set<std::uint64_t> seeds;
  for (const std::uint64_t seed : {std::uint64_t{1}, std::uint64_t{2}, std::uint64_t{1} << 32U}) {
    scenario.seed = seed;
    Workspace workspace(scenario);
    for (std::size_t robot = 0; robot < 3; ++robot) {
      for (std::int64_t later = 0; later < 3; ++later) {
        PlanInputs inputs = test::first_inputs(scenario, robot);
        inputs.slot.round += later;
        const auto draw = [&] {
          return problem_of_round(workspace, robot, inputs, {}, {}).search.seed;
        };
        EXPECT_EQ(draw(), draw());
        seeds.insert(draw());
        EXPECT_GT(draw() >> 32U, 0U) << "both halves of the seed are random";
        EXPECT_GT(draw() & 0xFFFFFFFFU, 0U);
      }
    }
  }
  EXPECT_EQ(seeds.size(), 27U);
}

// A teammate moves along its plan if one was received, at any distance. Otherwise it hovers at its
// observed position or, if not observed, at its start. Hovering teammates count only within or on
// the edge of the neighbourhood.
TEST(ProblemOfRound, HasTheRelevantTeammates) {
  scenario::Scenario scenario = test::lab_scenario();
  for (const double neighbourhood_m : {0.0, 2.0}) {
    scenario.network.neighbourhood_m = neighbourhood_m;
    for (const double at_m : {1.999, 2.001}) {
      for (const double side : {1.0, -1.0}) {
        PlanInputs inputs = test::first_inputs(scenario, 0);
        models::Trajectory committed;
        committed.start_time = inputs.slot.activation;
        committed.start = {0.4, 0.3, 0.0};
        const Pose2 place{0.4 + 0.6 * side * at_m, 0.3 - 0.8 * side * at_m, 1.0};
        inputs.mocap->bodies[2].world_from_body = lift(place, 0.1);
        inputs.team_plans["Q2"].trajectory = hover_at({50.0, 0.0, 0.0}, 1.5, {});
        inputs.attack = models::AttackNotice{{}, {"Q3", "Q9"}};
        const auto round_of = [&](const std::vector<int>& robots_without_sensing) {
          Workspace workspace(scenario);
          return problem_of_round(workspace, 0, inputs, committed, robots_without_sensing);
        };
        const RoundProblem round = round_of({0});
        const bool is_near = neighbourhood_m == 0.0 || at_m < 2.0;
        ASSERT_EQ(round.teammates.size(), is_near ? 2U : 1U) << neighbourhood_m << ' ' << at_m;
        ASSERT_EQ(round.search.teammates.size(), is_near ? 3U : 1U)
            << "including the position of Q3";
        EXPECT_EQ(round.teammates[0].robot, 1U);
        EXPECT_EQ(round.teammates[0].trajectory.start.x_m, 50.0);
        EXPECT_EQ(round.search.teammates[0].start.x_m, 50.0);
        EXPECT_FALSE(round.teammates[0].jammed);
        EXPECT_TRUE(round_of({2, 1}).teammates[0].jammed);
        if (is_near) {
          EXPECT_EQ(round.teammates[1].robot, 2U);
          EXPECT_TRUE(round.teammates[1].jammed) << "from the attack notice";
          const models::Trajectory& there = round.teammates[1].trajectory;
          EXPECT_LT((there.start.position_m() - place.position_m()).norm(), 1e-12);
          EXPECT_EQ(there.height_m, 2.0);
          EXPECT_EQ(there.start_time, inputs.slot.activation);
          EXPECT_EQ(round.search.teammates[2].height_m, 0.1);
        }
        inputs.attack.reset();
        inputs.mocap->bodies[2].occluded = true;  // its start is 2.66 m away
        const RoundProblem unseen = round_of({});
        ASSERT_EQ(unseen.teammates.size(), neighbourhood_m == 0.0 ? 2U : 1U);
        EXPECT_FALSE(unseen.teammates.back().jammed);
        if (neighbourhood_m == 0.0) {
          EXPECT_EQ(unseen.teammates[1].trajectory.start, scenario.robots[2].start);
        }
      }
    }
  }
}

// Unusable beliefs, and beliefs beyond the number of targets, are left out and counted. Beliefs
// just within the limits are used.
TEST(ProblemOfRound, CountsUnusableBeliefs) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.estimator.target_model = {models::TargetKind::kStatic, 2, 0.0};
  Workspace workspace(scenario);
  PlanInputs inputs = test::first_inputs(scenario, 0, 1);
  inputs.belief->grid =
      models::GridGeometry::covering(scenario.world.bounds, scenario.estimator.grid_resolution_m);
  inputs.belief->last_seen_utime.assign(static_cast<std::size_t>(inputs.belief->grid.size()),
                                        to_utime(inputs.slot.begin));  // all explored: no landmarks
  const auto unusable = [&] {
    models::Trajectory committed;
    committed.start_time = inputs.slot.activation;
    const RoundProblem round = problem_of_round(workspace, 0, inputs, committed, {});
    EXPECT_EQ(round.search.targets.size() + static_cast<std::size_t>(round.unusable_beliefs),
              inputs.belief->targets.size());
    return round.unusable_beliefs;
  };
  EXPECT_EQ(unusable(), 0);
  const auto of_last = [&](const models::Gaussian& belief) {
    inputs.belief->targets.back().information = *models::to_information(belief);
    return unusable();
  };
  const Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(of_last({Eigen::Vector2d(1.0, sign * 0.99e30), one}), 0);
    EXPECT_EQ(of_last({Eigen::Vector2d(1.0, sign * 1.01e30), one}), 1);
  }
  EXPECT_EQ(of_last({Eigen::Vector2d(1.0, 1.0), 0.99e30 * one}), 0);
  EXPECT_EQ(of_last({Eigen::Vector2d(1.0, 1.0), 1.01e30 * one}), 1);
  EXPECT_EQ(of_last({Eigen::Vector2d(1.0, 1.0), 1.01e-30 * one}), 0);
  EXPECT_EQ(of_last({Eigen::Vector2d(1.0, 1.0), 0.99e-30 * one}), 1);
  EXPECT_EQ(of_last({Eigen::Vector4d(1.0, 1.0, 0.0, 0.0), Eigen::Matrix4d::Identity()}), 1);
  EXPECT_EQ(of_last({Eigen::Vector2d(1.0, 1.0), one}), 0);
  inputs.belief->targets.push_back(inputs.belief->targets.back());
  EXPECT_EQ(unusable(), 1) << "five targets exist";
  inputs.belief->targets.pop_back();
  inputs.belief->stamp.time = inputs.slot.activation;
  EXPECT_EQ(unusable(), 0);
  inputs.belief->stamp.time += Duration{1};
  EXPECT_EQ(unusable(), 5) << "a time in the future";
}

// A grid is used if it is the scenario's or, where robots have neighbourhoods, a part of it, with
// one stamp per cell.
TEST(ProblemOfRound, UsesExplorationGridOfTheScenarioOnly) {
  scenario::Scenario scenario = test::lab_scenario();
  const auto whole =
      models::GridGeometry::covering(scenario.world.bounds, scenario.estimator.grid_resolution_m);
  const auto part = whole.window({1.0, 0.5}, 1.0);
  models::GridGeometry shifted = part;
  shifted.origin_m.x() += 0.3 * shifted.resolution_m;
  struct Case {
    models::GridGeometry grid;
    double neighbourhood_m;
    std::size_t too_many;
    bool is_used;
  };
  for (const Case& each :
       {Case{whole, 0.0, 0, true}, Case{whole, 9.0, 0, true}, Case{part, 9.0, 0, true},
        Case{part, 0.0, 0, false}, Case{shifted, 9.0, 0, false}, Case{whole, 0.0, 1, false}}) {
    scenario.network.neighbourhood_m = each.neighbourhood_m;
    PlanInputs inputs = test::first_inputs(scenario, 0, 1);
    inputs.belief->grid = each.grid;
    inputs.belief->last_seen_utime.assign(
        static_cast<std::size_t>(each.grid.size()) + each.too_many, 0);
    for (const int landmarks_max : {0, 1, 3}) {
      scenario.planner.exploration.landmarks_max = landmarks_max;
      Workspace workspace(scenario);
      models::Trajectory committed;
      committed.start_time = inputs.slot.activation;
      const RoundProblem round = problem_of_round(workspace, 0, inputs, committed, {});
      const std::size_t landmarks = round.search.targets.size() - inputs.belief->targets.size();
      EXPECT_EQ(landmarks, each.is_used ? static_cast<std::size_t>(landmarks_max) : 0U);
      EXPECT_EQ(round.unusable_beliefs, each.is_used || landmarks_max == 0 ? 0 : 1);
    }
  }
}

TEST(ProblemOfRound, UsesMapGridOfTheScenarioOnly) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.objective = scenario::PlanObjective::kMapping;
  Workspace workspace(scenario);
  PlanInputs inputs = test::first_inputs(scenario, 0, 1);
  const auto round_of = [&] {
    models::Trajectory committed;
    committed.start_time = inputs.slot.activation;
    return problem_of_round(workspace, 0, inputs, committed, {});
  };
  EXPECT_TRUE(round_of().looks.empty());
  EXPECT_EQ(round_of().unusable_maps, 0);
  EXPECT_TRUE(round_of().search.targets.empty()) << "a mapping robot ignores target beliefs";
  models::RobotMap& map = inputs.map.emplace();
  map.grid = models::map_geometry(scenario.world, scenario.mapping);
  map.team_looks.assign(static_cast<std::size_t>(map.grid.size()), -2);
  map.own_looks.assign(static_cast<std::size_t>(map.grid.size()), 5);
  EXPECT_EQ(round_of().looks, map.team_looks);
  EXPECT_EQ(round_of().unusable_maps, 0);
  map.team_looks.push_back(-2);
  EXPECT_TRUE(round_of().looks.empty());
  EXPECT_EQ(round_of().unusable_maps, 1);
  map.team_looks.pop_back();
  map.grid.origin_m.y() += 0.1;
  EXPECT_TRUE(round_of().looks.empty());
  EXPECT_EQ(round_of().unusable_maps, 1);
}

TEST_F(PlansWithMixtures, HaveOneTargetPerComponent) {
  add(1, {0.5, 0.3, 0.2});
  add(4, {0.97, 0.03});  // below 1/32 a component is dropped; one position comes from the belief
  const std::vector<Eigen::Vector2d> places_m = this->places_m();
  const double a = ahead_m();
  const std::vector<Eigen::Vector2d> right_m = {{0 + a, 0}, {1 + a, 1}, {1 + a, 2}, {1 + a, 3},
                                                {2 + a, 0}, {3 + a, 0}, {4 + a, 0}};
  ASSERT_EQ(places_m.size(), right_m.size());
  for (std::size_t i = 0; i < right_m.size(); ++i) {
    EXPECT_LT((places_m[i] - right_m[i]).norm(), 1e-9) << i;
  }
}

TEST_F(PlansWithMixtures, UseOnlyTheMixtureOfTheirBelief) {
  add(1, {0.5, 0.5});
  EXPECT_EQ(places_m().size(), 6U);
  const models::BeliefMixture right = *inputs_.mixture;
  inputs_.mixture->step = 2;
  EXPECT_EQ(places_m().size(), 5U);
  inputs_.mixture = right;
  inputs_.mixture->stamp.run_id = 8;
  EXPECT_EQ(places_m().size(), 5U);
  inputs_.mixture = right;
  inputs_.mixture->stamp.time += Duration{1};
  EXPECT_EQ(places_m().size(), 5U);
  inputs_.mixture = right;
  inputs_.mixture->robot = "Q2";
  EXPECT_EQ(places_m().size(), 5U);
  inputs_.mixture = right;
  inputs_.mixture->targets[0].components[1].belief = {Eigen::Vector2d::Zero(),
                                                      Eigen::Matrix2d::Identity()};
  EXPECT_EQ(places_m().size(), 5U) << "state of another model";
  inputs_.mixture = right;
  EXPECT_EQ(places_m().size(), 6U);
}

TEST_F(PlansWithMixtures, KeepTheTargetLimit) {
  EXPECT_EQ(components_max(scenario_), 35U);
  for (int id = 0; id < 5; ++id) {
    add(id, std::vector<double>(8, 0.125));
  }
  EXPECT_EQ(places_m().size(), 40U);
  inputs_.mixture->targets[0].components.assign(10, {0.1, gaussian(0, 1.0)});
  EXPECT_EQ(places_m().size(), 10U + 3 * 8U + 1U) << "the last target uses its belief";
  scenario_.estimator.samples = false;
  EXPECT_EQ(components_max(scenario_), 0U);
  EXPECT_EQ(places_m().size(), 5U);
  scenario_.robots[1].detection.detects_ids = false;
  EXPECT_EQ(components_max(scenario_), 35U);
}

}  // namespace
}  // namespace vantage::planner
