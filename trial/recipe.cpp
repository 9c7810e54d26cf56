#include "trial/recipe.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "drivers/sensor/app/node.hpp"
#include "estimator/app/node.hpp"
#include "localizer/app/node.hpp"
#include "planner/app/node.hpp"
#include "scenario/reader/camera_yaml.hpp"
#include "sim/app/node.hpp"
#include "trial/robot_processes.hpp"
#include "trial/simulated_camera.hpp"

namespace vantage::trial {
namespace {

using MakeFor = std::function<std::unique_ptr<bus::Node>(bus::Bus&, const bus::Clock&,
                                                         const std::string& robot)>;

template <class RobotNode>
MakeFor from(const scenario::Scenario& scenario) {
  return [&scenario](bus::Bus& bus, const bus::Clock& clock, const std::string& robot) {
    return std::make_unique<RobotNode>(bus, clock, scenario, robot);
  };
}

MakeFor planners_of(const scenario::Scenario& scenario) {
  return [workspace = std::make_shared<planner::Workspace>(scenario)](
             bus::Bus& bus, const bus::Clock& clock, const std::string& robot) {
    // In real time each node has its own thread, so each planner needs its own workspace.
    auto own = clock.is_real_time() ? std::make_shared<planner::Workspace>(workspace->scenario())
                                    : workspace;
    return std::make_unique<planner::PlannerNode>(bus, clock, std::move(own), robot);
  };
}

}  // namespace

std::vector<NodeRecipe> trial_recipes(const scenario::Scenario& scenario) {
  const std::vector<scenario::CameraSpec> cameras = scenario::cameras_of(scenario);
  std::vector<NodeRecipe> out;
  out.push_back({"SIM",
                 [&scenario](bus::Bus& bus, const bus::Clock& clock) {
                   return std::make_unique<sim::SimNode>(bus, clock, scenario);
                 },
                 ""});
  const std::array<MakeFor, kProcessOrder.size()> makes = {
      from<localizer::LocalizerNode>(scenario), from<drivers::SensorNode>(scenario),
      from<estimator::EstimatorNode>(scenario), planners_of(scenario)};
  for (std::size_t i = 0; i < makes.size(); ++i) {
    for (const scenario::RobotSpec& robot : scenario.robots) {
      const auto camera = std::find_if(cameras.begin(), cameras.end(), [&](const auto& each) {
        return each.robot == robot.name && each.source == scenario::kSimulatedSource;
      });
      if (kProcessOrder[i] == std::string_view("sensor") && camera != cameras.end()) {
        out.push_back({node_name(process_name("camera", robot.name)),
                       [&scenario, spec = *camera](bus::Bus& bus, const bus::Clock& clock) {
                         return simulated_camera(bus, clock, scenario, spec);
                       },
                       robot.name});
      }
      const std::vector<std::string> own = own_processes(scenario, robot);
      if (std::find(own.begin(), own.end(), kProcessOrder[i]) == own.end()) {
        continue;
      }
      out.push_back({node_name(process_name(kProcessOrder[i], robot.name)),
                     [make = makes[i], name = robot.name](bus::Bus& bus, const bus::Clock& clock) {
                       return make(bus, clock, name);
                     },
                     robot.name});
    }
  }
  return out;
}

}  // namespace vantage::trial
