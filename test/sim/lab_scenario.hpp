#pragma once

#include <string>

#include "core/angle.hpp"
#include "models/motion/unicycle.hpp"
#include "scenario/scenario.hpp"

namespace vantage::test {

/// Returns the scenario of the hardware experiment: 4 × 8 m with two boxes, three quadrotors at
/// heights of 1.0, 1.5 and 2.0 m, and five rovers of radius 0.2 m with random start positions.
inline scenario::Scenario lab_scenario() {
  scenario::Scenario scenario;
  scenario.name = "lab";
  scenario.world.bounds = {{0.0, 0.0}, {4.0, 8.0}};
  scenario.world.ceiling_m = 3.0;
  scenario.world.obstacles = {{{{1.0, 2.5}, {1.5, 3.0}}, 0.5}, {{{2.5, 5.0}, {3.0, 5.5}}, 0.5}};
  for (int i = 0; i < 3; ++i) {
    scenario::RobotSpec robot;
    robot.name = std::string("Q").append(std::to_string(i + 1));
    robot.start = {1.0 + i, 1.0, kPi / 2};
    robot.height_m = 1.0 + 0.5 * i;
    robot.primitives = models::lab_primitives();
    robot.limits.speed_max_mps = 1.0;
    robot.sensor.kind = models::SensorKind::kRangeBearing;
    robot.sensor.range_max_m = 1.0;
    robot.sensor.range_min_m = 0.05;
    robot.sensor.range_sigma_m = 0.3;
    scenario.robots.push_back(robot);
  }
  for (int i = 0; i < 5; ++i) {
    scenario::TargetSpec target;
    target.name = std::string("ROVER").append(std::to_string(i + 1));
    target.id = i;
    scenario.targets.push_back(target);
  }
  return scenario;
}

}  // namespace vantage::test
