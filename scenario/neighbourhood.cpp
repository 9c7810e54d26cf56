#include "scenario/neighbourhood.hpp"

#include <algorithm>

namespace vantage::scenario {

double least_neighbourhood_m(const Scenario& scenario) {
  const PlannerSpec& planner = scenario.planner;
  const double plan_s = planner.horizon_steps * planner.step_s;
  const double round_s = planner.execute_steps * planner.step_s;
  double reach_m = 0.0;
  double sight_m = 0.0;
  for (const RobotSpec& robot : scenario.robots) {
    const double v_mps = robot.limits.speed_max_mps;
    const double stop_m = v_mps * v_mps / (2.0 * robot.limits.brake_mps2);
    reach_m = std::max(reach_m, v_mps * (plan_s + 2.0 * round_s) + stop_m);
    sight_m = std::max(sight_m, v_mps * (plan_s + round_s) + robot.sensor.range_max_m);
  }
  const double apart_m = planner.separation_m + 2.0 * planner.tracking_tolerance_m;
  return std::max({2.0 * reach_m + apart_m, scenario.network.communication_range_m, sight_m});
}

}  // namespace vantage::scenario
