#include "trial/recipe.hpp"

#include <utility>

#include "drivers/sensor/app/node.hpp"
#include "estimator/app/node.hpp"
#include "planner/app/node.hpp"
#include "sim/app/node.hpp"

namespace vantage::trial {
namespace {

template <class RobotNode>
void add_per_robot(std::vector<NodeRecipe>& out, const scenario::Scenario& scenario,
                   const std::string& prefix) {
  for (const scenario::RobotSpec& robot : scenario.robots) {
    out.push_back({prefix + robot.name,
                   [&scenario, name = robot.name](bus::Bus& bus, const bus::Clock& clock) {
                     return std::make_unique<RobotNode>(bus, clock, scenario, name);
                   }});
  }
}

}  // namespace

std::vector<NodeRecipe> trial_recipes(const scenario::Scenario& scenario) {
  std::vector<NodeRecipe> out;
  out.push_back({"SIM", [&scenario](bus::Bus& bus, const bus::Clock& clock) {
                   return std::make_unique<sim::SimNode>(bus, clock, scenario);
                 }});
  add_per_robot<drivers::SensorNode>(out, scenario, "SENSOR_");
  add_per_robot<estimator::EstimatorNode>(out, scenario, "ESTIMATOR_");
  const auto workspace = std::make_shared<planner::Workspace>(scenario);
  for (const scenario::RobotSpec& robot : scenario.robots) {
    out.push_back({"PLANNER_" + robot.name,
                   [workspace, name = robot.name](bus::Bus& bus, const bus::Clock& clock) {
                     // In real time each node has a thread, and planners search at the same time.
                     auto own = clock.is_real_time()
                                    ? std::make_shared<planner::Workspace>(workspace->scenario())
                                    : workspace;
                     return std::make_unique<planner::PlannerNode>(bus, clock, std::move(own),
                                                                   name);
                   }});
  }
  return out;
}

}  // namespace vantage::trial
