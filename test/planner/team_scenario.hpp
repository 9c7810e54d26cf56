#pragma once

#include "models/scenario/scenario.hpp"

namespace vantage::planner::test {

/// The 4 × 8 m lab with two boxes and three quadrotors, planned by nodes so that nothing depends
/// on the machine.
inline models::Scenario lab_scenario() {
  models::Scenario scenario;
  scenario.name = "lab";
  scenario.world.bounds = {{-4.0, -2.0}, {4.0, 2.0}};
  scenario.world.ceiling_m = 3.0;
  scenario.world.obstacles = {{{{-1.8, 0.5}, {-1.2, 1.1}}, 2.5}, {{{1.2, -1.1}, {1.8, -0.5}}, 2.5}};
  for (int i = 0; i < 3; ++i) {
    models::RobotSpec robot;
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

}  // namespace vantage::planner::test
