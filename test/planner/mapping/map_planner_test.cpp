#include "planner/mapping/map_planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/robot/robot_planner.hpp"
#include "planner/robot/trajectory_tools.hpp"
#include "test/planner/robot/team_scenario.hpp"
#include "test/support/random.hpp"

namespace vantage::planner {
namespace {

using vantage::test::Random;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

scenario::Scenario mapping_scenario() {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.targets.clear();
  scenario.planner.objective = scenario::PlanObjective::kMapping;
  scenario.planner.horizon_steps = 4;
  scenario.mapping.scanner.beams = 24;
  scenario.mapping.planned_beams = 24;
  return scenario;
}

// Returns a map in which 40 % of the cells are known.
models::RobotMap map_in_patches(const scenario::Scenario& scenario, Random& random) {
  models::RobotMap map;
  map.grid = models::map_geometry(scenario.world, scenario.mapping);
  for (int cell = 0; cell < map.grid.size(); ++cell) {
    const bool is_known = random.uniform(0.0, 1.0) < 0.4;
    map.team_looks.push_back(static_cast<std::int16_t>(is_known ? random.integer(-3, 1) : 0));
  }
  map.own_looks = map.team_looks;
  return map;
}

// A round of robot 0 in the lab: the robot moves from a random position, and two teammates continue
// their motion.
struct Bench {
  Bench(const scenario::Scenario& lab, Random& random)
      : scenario(lab), field(scenario.world, 0.05), map(map_in_patches(scenario, random)) {
    const scenario::RobotSpec& robot = scenario.robots[0];
    problem.start_time = kStart;
    problem.start = {random.uniform(-3.4, 3.4), random.uniform(-1.4, 1.4),
                     random.uniform(-kPi, kPi)};
    problem.start_speed_mps = 1.0;
    problem.height_m = 1.0;
    problem.controls = robot.primitives;
    problem.horizon_steps = scenario.planner.horizon_steps;
    problem.step_s = scenario.planner.step_s;
    problem.world = &scenario.world;
    problem.field = &field;
    problem.clearance_m = robot.limits.radius_m + scenario.planner.obstacle_margin_m;
    problem.separation_m = 1.0;
    problem.brake_mps2 = robot.limits.brake_mps2;
    for (int i = 0; i < 2; ++i) {
      FixedTeammate mate;
      mate.trajectory = hover_at(
          {random.uniform(-3.4, 3.4), random.uniform(-1.4, 1.4), random.uniform(-kPi, kPi)},
          1.5 + 0.5 * i, kStart);
      mate.trajectory.segments = {{{1.0, 1.0}, 1.5, 0.0}};
      mate.jammed = i == 1;
      teammates.push_back(mate);
      problem.teammates.push_back(mate.trajectory);
    }
  }

  scenario::Scenario scenario;
  models::DistanceField field;
  models::RobotMap map;
  SearchProblem problem;
  std::vector<FixedTeammate> teammates;
};

// Returns the routes of scans that do not depend on the plan: the robot's start pose, and the route
// of the teammate that is not jammed.
std::vector<MapRoute> fixed_routes(const Bench& bench) {
  std::vector<MapRoute> routes(2);
  routes[0].poses = {bench.problem.start};
  for (int t = 0; t <= bench.problem.horizon_steps; ++t) {
    const Time when = kStart + from_seconds(t * bench.problem.step_s);
    routes[1].poses.push_back(models::at(bench.teammates[0].trajectory, when).world_from_body);
  }
  return routes;
}

TEST(MapPlanner, FindsBestSafeRoute) {
  Random random(5401);
  const scenario::Scenario scenario = mapping_scenario();
  int compared = 0;
  for (int i = 0; i < 40; ++i) {
    const Bench bench(scenario, random);
    const SearchProblem& problem = bench.problem;
    MapPlanner planner(scenario);
    const MapPlan plan =
        planner.plan(problem, bench.map.team_looks, bench.teammates, Deadline::never());
    const SearchResult& result = plan.result;

    const models::OccupancyBelief belief =
        models::belief_of(bench.map.grid, bench.map.team_looks, scenario.mapping);
    ViewTable views(belief, scenario.mapping.scanner, {});
    DriveOptions drive_options;
    drive_options.radius_m = problem.clearance_m;
    const DriveMap drive(belief, drive_options);
    MappingSearch search(views, drive, {});
    const std::vector<MapRoute> fixed = fixed_routes(bench);
    const auto gain = [&](const MapRoute& route) {
      const std::vector<const MapRoute*> before{&fixed[0], &fixed[1]};
      const std::vector<const MapRoute*> all{&fixed[0], &fixed[1], &route};
      return search.value(all) - search.value(before);
    };
    const double farthest_m = 0.2 * (bench.map.grid.columns + bench.map.grid.rows);
    const auto worth = [&](const MapRoute& route) {
      return gain(route) -
             0.5 * std::min(farthest_m, drive.frontier_distance_m(route.poses.back().position_m()));
    };

    MotionTable motion(static_cast<int>(problem.controls.size()), problem.horizon_steps, 2);
    motion.reset(problem);
    double best_nats = -std::numeric_limits<double>::infinity();
    MapRoute route;
    const auto try_all = [&](const auto& self, const Pose2& at) -> void {
      const int depth = static_cast<int>(route.poses.size());
      for (int c = 0; c < static_cast<int>(problem.controls.size()); ++c) {
        const Pose2 next = models::step_unicycle(at, problem.controls[static_cast<std::size_t>(c)],
                                                 problem.step_s);
        if (!motion.is_free(at, std::cos(at.yaw_rad), std::sin(at.yaw_rad), c, depth)) {
          continue;
        }
        route.poses.push_back(next);
        if (depth + 1 < problem.horizon_steps) {
          self(self, next);
        } else if (motion.can_stop(next, c, depth + 1)) {
          best_nats = std::max(best_nats, worth(route));
        }
        route.poses.pop_back();
      }
    };
    try_all(try_all, problem.start);
    if (!std::isfinite(best_nats)) {
      EXPECT_LT(result.moving_steps, problem.horizon_steps) << i;
      EXPECT_EQ(result.lower_bound, -std::numeric_limits<double>::infinity());
      continue;
    }
    ++compared;
    ASSERT_TRUE(result.found);
    EXPECT_EQ(result.moving_steps, problem.horizon_steps);
    EXPECT_NEAR(-result.cost, best_nats, 1e-9) << i;
    EXPECT_EQ(result.lower_bound, result.cost);
    route.poses = result.poses;
    EXPECT_NEAR(worth(route), best_nats, 1e-9);
    EXPECT_NEAR(plan.gain_nats, gain(route), 1e-9);
  }
  EXPECT_GE(compared, 15);
}

// The plan uses planned_beams beams, for any number of beams of the scanner.
TEST(MapPlanner, PlansWithTheConfiguredNumberOfBeams) {
  Random random(5404);
  scenario::Scenario few = mapping_scenario();
  few.mapping.scanner.beams = few.mapping.planned_beams = 12;
  scenario::Scenario many = few;
  many.mapping.scanner.beams = 36;
  scenario::Scenario all = many;
  all.mapping.planned_beams = 36;
  int different = 0;
  for (int i = 0; i < 5; ++i) {
    const Bench bench(few, random);
    const auto cost_by = [&](const scenario::Scenario& scenario) {
      MapPlanner planner(scenario);
      return planner
          .plan(bench.problem, bench.map.team_looks, bench.teammates, Deadline::nodes(500))
          .result.cost;
    };
    EXPECT_EQ(cost_by(many), cost_by(few));
    different += cost_by(all) != cost_by(few) ? 1 : 0;
  }
  EXPECT_GE(different, 3);
}

TEST(MapPlanner, ImprovesMonotonicallyWithBudget) {
  Random random(5402);
  const scenario::Scenario scenario = mapping_scenario();
  int improved = 0;
  for (int i = 0; i < 5; ++i) {
    const Bench bench(scenario, random);
    MapPlanner planner(scenario);
    const auto search = [&](const Deadline& deadline) {
      return planner.plan(bench.problem, bench.map.team_looks, bench.teammates, deadline).result;
    };
    const SearchResult whole = search(Deadline::never());
    double last_cost = std::numeric_limits<double>::infinity();
    for (std::int64_t nodes = 0; nodes < whole.work_nodes; nodes += 1 + nodes / 4) {
      const SearchResult cut = search(Deadline::nodes(nodes));
      EXPECT_LE(cut.work_nodes, nodes);
      EXPECT_EQ(cut.stop_reason, StopReason::kDeadline);
      EXPECT_EQ(cut.lower_bound, -std::numeric_limits<double>::infinity()) << "no bound was proven";
      if (cut.moving_steps == bench.problem.horizon_steps) {
        EXPECT_LE(cut.cost, last_cost);
        improved += cut.cost < last_cost ? 1 : 0;
        last_cost = cut.cost;
      } else {
        EXPECT_TRUE(std::isinf(last_cost)) << "a complete plan was lost";
      }
      const SearchResult again = search(Deadline::nodes(cut.replay_budget_nodes()));
      EXPECT_EQ(again.controls, cut.controls);
      EXPECT_EQ(again.cost, cut.cost);
      EXPECT_EQ(again.work_nodes, cut.work_nodes);
    }
    const SearchResult again = search(Deadline::nodes(whole.replay_budget_nodes()));
    EXPECT_EQ(again.controls, whole.controls);
    EXPECT_EQ(again.stop_reason, StopReason::kFinished);
    if (whole.moving_steps == bench.problem.horizon_steps) {
      EXPECT_LE(whole.cost, last_cost);
    }
  }
  EXPECT_GE(improved, 5);
}

// The result is optimal if the search finished with all steps; otherwise it has no bound. The
// reported counts match the work.
TEST(MapPlanner, ReportsItsCertificate) {
  Random random(5405);
  const scenario::Scenario scenario = mapping_scenario();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  int proven = 0;
  for (int i = 0; i < 6; ++i) {
    const Bench bench(scenario, random);
    MapPlanner planner(scenario);
    for (const bool is_limited : {false, true}) {
      const MapPlan plan = planner.plan(bench.problem, bench.map.team_looks, bench.teammates,
                                        is_limited ? Deadline::nodes(60) : Deadline::never());
      const SearchResult& result = plan.result;
      const bool is_cut = is_limited && result.work_nodes == 60;
      const bool is_best = !is_cut && result.moving_steps == bench.problem.horizon_steps;
      proven += is_best ? 1 : 0;
      EXPECT_EQ(result.epsilon, is_best ? 0.0 : kInfinite);
      EXPECT_EQ(result.delta_m, is_best ? 0.0 : kInfinite);
      EXPECT_EQ(result.passes, is_best ? 1 : 0);
      EXPECT_EQ(result.lower_bound, is_best ? result.cost : -kInfinite);
      EXPECT_EQ(result.stop_reason, is_cut ? StopReason::kDeadline : StopReason::kFinished);
      EXPECT_LT(result.nodes_generated, result.work_nodes);
      EXPECT_TRUE(result.nodes_generated >= bench.problem.horizon_steps || !is_best) << i;
      EXPECT_EQ(static_cast<int>(result.controls.size()), result.moving_steps);
      EXPECT_GE(plan.gain_nats, 0.0);
    }
  }
  EXPECT_GT(proven, 2);
}

// At 1 m/s the robot stops within 25 cm. 40 cm before the wall no plan exists at 1 m/s, but one
// exists at rest.
TEST(MapPlanner, FindsNothingWhereItCannotStop) {
  Random random(5406);
  const scenario::Scenario scenario = mapping_scenario();
  Bench bench(scenario, random);
  bench.problem.teammates.clear();
  bench.problem.start = {3.6, 0.0, 0.0};
  MapPlanner planner(scenario);
  for (const double speed_mps : {1.0, 0.0}) {
    bench.problem.start_speed_mps = speed_mps;
    const MapPlan plan = planner.plan(bench.problem, {}, {}, Deadline::never());
    EXPECT_EQ(plan.result.found, speed_mps == 0.0);
    EXPECT_EQ(plan.result.moving_steps, 0);
    EXPECT_EQ(plan.result.lower_bound, -std::numeric_limits<double>::infinity());
    EXPECT_EQ(plan.gain_nats, 0.0) << "this view was already observed";
  }
}

// An empty list means that no cell was observed. A list of another size is refused.
TEST(MapPlanner, RequiresObservationCountPerCell) {
  Random random(5407);
  const scenario::Scenario scenario = mapping_scenario();
  const Bench bench(scenario, random);
  MapPlanner planner(scenario);
  const auto cost = [&](const models::CellCounts& looks) {
    return planner.plan(bench.problem, looks, bench.teammates, Deadline::nodes(300)).result.cost;
  };
  models::CellCounts looks(bench.map.team_looks.size(), 0);
  EXPECT_EQ(cost({}), cost(looks));
  looks.pop_back();
  EXPECT_THROW(cost(looks), UsageError);
  looks.resize(bench.map.team_looks.size() + 1, 0);
  EXPECT_THROW(cost(looks), UsageError);
}

TEST(RobotPlanner, UsesTheSameFallbacksForMapping) {
  const scenario::Scenario scenario = mapping_scenario();
  const double clearance_m =
      scenario.robots[0].limits.radius_m + scenario.planner.obstacle_margin_m;
  Random random(5403);
  for (int i = 0; i < 20; ++i) {
    std::map<std::string, models::RobotPlan> plans;
    for (std::size_t index = 0; index < 3; ++index) {
      RobotPlanner planner(scenario, scenario.robots[index].name);
      PlanInputs inputs = test::first_inputs(scenario, index);
      inputs.map = map_in_patches(scenario, random);
      inputs.team_plans = plans;
      const auto plan = planner.plan(inputs, Deadline::nodes(i % 2 == 0 ? 2'000 : 7));
      ASSERT_TRUE(plan);
      EXPECT_TRUE(models::is_clear(scenario.world, plan->trajectory, plan->trajectory.start_time,
                                   clearance_m - 0.02));
      for (const auto& [name, other] : plans) {
        EXPECT_TRUE(models::keeps_separation(plan->trajectory, other.trajectory,
                                             plan->trajectory.start_time,
                                             scenario.planner.separation_m));
      }
      EXPECT_LE(plan->nodes, 2'001);
      plans[scenario.robots[index].name] = *plan;
      // After a late search, the planner continues the committed motion.
      const auto instead = planner.plan_without_search(inputs);
      ASSERT_TRUE(instead);
      EXPECT_NE(instead->source, models::PlanSource::kSearched);
    }
  }
}

TEST(RobotPlanner, IncludesScansOfTeammatesExceptTheBait) {
  scenario::Scenario scenario = mapping_scenario();
  scenario.planner.attacks_max = 1;
  const Deadline deadline = Deadline::nodes(20'000);
  // Q2 plans the same route as Q1; only their heights differ.
  scenario.robots[1].start = scenario.robots[0].start;
  scenario.robots[1].height_m = 2.5;
  PlanInputs inputs = test::first_inputs(scenario, 0);
  RobotPlanner planner(scenario, "Q1");
  const auto alone = planner.propose(inputs, deadline);
  ASSERT_TRUE(alone);
  EXPECT_GT(alone->value_nats, 0.0);
  RobotPlanner mate(scenario, "Q2");
  const auto theirs = mate.plan(test::first_inputs(scenario, 1), deadline);
  ASSERT_TRUE(theirs);
  inputs.team_plans["Q2"] = *theirs;
  const auto beside = planner.plan(inputs, deadline);
  EXPECT_GT(beside->cost, alone->plan.cost) << "Q2 observes a part of it";

  inputs.attack = models::AttackNotice{{}, {"Q2"}};
  EXPECT_EQ(planner.plan(inputs, deadline)->cost, alone->plan.cost) << "Q2 is jammed";
  inputs.attack.reset();
  auto bait = *alone;
  bait.plan.robot = "Q2";
  bait.plan.round = inputs.slot.round;
  inputs.proposals["Q2"] = bait;
  EXPECT_EQ(planner.plan(inputs, deadline)->cost, alone->plan.cost) << "Q2 is the bait";
  inputs.proposals.clear();
  inputs.proposals["Q1"] = *alone;
  const auto kept = planner.plan(inputs, deadline);
  EXPECT_EQ(kept->nodes, 0) << "the bait keeps its proposal";
  EXPECT_EQ(kept->cost, alone->plan.cost);
}

TEST(RobotPlanner, IgnoresMapsOfAnotherGrid) {
  const scenario::Scenario scenario = mapping_scenario();
  RobotPlanner planner(scenario, "Q1");
  const Deadline deadline = Deadline::nodes(20'000);
  PlanInputs inputs = test::first_inputs(scenario, 0);
  const auto unknown = planner.plan(inputs, deadline);
  ASSERT_TRUE(unknown);
  inputs.map = models::RobotMap{};
  inputs.map->grid = {{0.0, 0.0}, 0.2, 2, 2};
  inputs.map->team_looks = {-9, -9, -9, -9};
  EXPECT_EQ(planner.plan(inputs, deadline)->cost, unknown->cost);
}

}  // namespace
}  // namespace vantage::planner
