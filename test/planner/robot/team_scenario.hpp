#pragma once

#include <random>

#include "planner/robot/robot_planner.hpp"
#include "planner/robot/round.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner::test {

/// Returns the 4 × 8 m lab with two boxes and three quadrotors. Planning is limited by nodes, so
/// that results do not depend on the machine.
inline scenario::Scenario lab_scenario() {
  scenario::Scenario scenario;
  scenario.name = "lab";
  scenario.world.bounds = {{-4.0, -2.0}, {4.0, 2.0}};
  scenario.world.ceiling_m = 3.0;
  scenario.world.obstacles = {{{{-1.8, 0.5}, {-1.2, 1.1}}, 2.5}, {{{1.2, -1.1}, {1.8, -0.5}}, 2.5}};
  for (int i = 0; i < 3; ++i) {
    scenario::RobotSpec robot;
    robot.name = "Q" + std::to_string(i + 1);
    robot.start = {-3.0 + 3.0 * i, 0.0, 0.5 * i};
    robot.height_m = 1.0 + 0.5 * i;
    robot.primitives = models::lab_primitives();
    robot.limits.speed_max_mps = 1.0;
    robot.sensor.range_max_m = 1.0;
    robot.sensor.range_min_m = 0.1;
    robot.sensor.range_sigma_m = 0.3;
    scenario.robots.push_back(robot);
  }
  for (int i = 0; i < 5; ++i) {
    scenario.targets.push_back({"R" + std::to_string(i + 1), i, std::nullopt, 0.2});
  }
  scenario.estimator.target_model = {models::TargetKind::kRandomWalk, 2, 0.15};
  scenario.planner.execute_steps = 2;
  scenario.planner.node_budget = 1'500;
  return scenario;
}

/// Returns the lab scenario with wind in the middle. The team's objective includes energy, and its
/// team algorithm is local search.
inline scenario::Scenario energy_scenario() {
  scenario::Scenario scenario = lab_scenario();
  scenario.world.regions = {{"wind", {{-0.8, -2.0}, {0.8, 2.0}}, 2.0}};
  scenario.planner.team_algorithm = scenario::TeamAlgorithm::kLocalSearch;
  scenario.planner.candidates_max = 60;
  for (scenario::RobotSpec& robot : scenario.robots) {
    robot.primitives.push_back({0.0, 0.0});
    robot.energy = {0.05, 0.0, 1.0, 2.0, {"wind"}};
  }
  return scenario;
}

/// Returns the inputs of robot `index` in its first round: all robots are at their starts.
inline PlanInputs first_inputs(const scenario::Scenario& scenario, std::size_t index) {
  PlanInputs inputs;
  constexpr std::int64_t kFirstRound = 1'700'000'000;  // rounds of 1 s since the epoch
  inputs.slot = RoundSchedule(scenario.planner, static_cast<int>(index),
                              static_cast<int>(scenario.robots.size()))
                    .slot(kFirstRound);
  models::MocapFrame mocap;
  mocap.stamp.time = inputs.slot.begin;
  for (const scenario::RobotSpec& robot : scenario.robots) {
    mocap.bodies.push_back({robot.name, lift(robot.start, robot.height_m), false});
  }
  inputs.mocap = mocap;
  return inputs;
}

/// Returns the same inputs with a belief of five targets drawn from `seed`.
inline PlanInputs first_inputs(const scenario::Scenario& scenario, std::size_t index,
                               unsigned seed) {
  PlanInputs inputs = first_inputs(scenario, index);
  models::RobotBelief belief;
  belief.stamp.time = inputs.slot.begin;
  std::mt19937_64 rng(seed);
  for (int id = 0; id < 5; ++id) {
    const double x_m = std::uniform_real_distribution(-4.0, 4.0)(rng);
    const double y_m = std::uniform_real_distribution(-2.0, 2.0)(rng);
    const models::Gaussian guess{Eigen::Vector2d(x_m, y_m), 0.3 * Eigen::Matrix2d::Identity()};
    belief.targets.push_back({id, *models::to_information(guess), inputs.slot.begin});
  }
  inputs.belief = belief;
  return inputs;
}

}  // namespace vantage::planner::test
