#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.hpp"

namespace vantage::test {

/// Returns a scenario in which `robots` map 8 × 6 m, communicate within 3 m and scan every 0.5 s.
inline scenario::Scenario mapping_scenario(const std::vector<std::string>& robots) {
  scenario::Scenario scenario;
  scenario.world.bounds = {{0.0, 0.0}, {8.0, 6.0}};
  for (const std::string& name : robots) {
    scenario::RobotSpec robot;
    robot.name = name;
    scenario.robots.push_back(robot);
  }
  scenario.planner.objective = scenario::PlanObjective::kMapping;
  scenario.planner.step_s = 0.5;
  scenario.network.communication_range_m = 3.0;
  return scenario;
}

}  // namespace vantage::test
