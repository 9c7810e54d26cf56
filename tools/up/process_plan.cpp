#include "tools/up/process_plan.hpp"

#include <algorithm>

namespace vantage::tools {

namespace {

using models::DeviceSource;

bool has_driver(const models::RobotSpec& robot) { return robot.device != DeviceSource::kDirect; }

}  // namespace

std::vector<std::string> robots_with_driver(const models::Scenario& scenario) {
  std::vector<std::string> out;
  for (const models::RobotSpec& robot : scenario.robots) {
    if (has_driver(robot)) {
      out.push_back(robot.name);
    }
  }
  return out;
}

std::vector<std::string> device_faults(const models::Scenario& scenario) {
  std::vector<std::string> out;
  for (const models::RobotSpec& robot : scenario.robots) {
    const bool is_real = robot.device == DeviceSource::kReal;
    if (is_real && scenario.mocap.device != DeviceSource::kReal) {
      out.push_back("robot " + robot.name +
                    " is real, and a simulated mocap system does not see it: "
                    "mocap needs device 'real'");
    }
    const bool has_autopilot = robot.autopilot && !robot.autopilot->url.empty();
    if (has_driver(robot) && !has_autopilot && !robot.rover) {
      out.push_back("robot " + robot.name + " has device '" + (is_real ? "real" : "wire") +
                    "' and no `autopilot: {url: …}` or `rover: {url: …}` to reach it by");
    }
  }
  return out;
}

std::vector<ProcessSpec> process_plan(const models::Scenario& scenario,
                                      const ProcessPlaces& places) {
  const auto command = [&places](const std::string& program) {
    return std::vector<std::string>{places.executables + "/" + program, "--scenario",
                                    places.scenario_path, "--url", places.url};
  };
  const auto runs = [&](const std::string& part) {
    return places.host.empty() || scenario.runs_on(places.host, part);
  };
  std::vector<ProcessSpec> out;
  const auto add_for = [&](const std::string& program, const std::string& robot) {
    ProcessSpec process{program + " " + robot, command("vantage-" + program)};
    process.arguments.insert(process.arguments.end(), {"--robot", robot});
    out.push_back(std::move(process));
  };
  const bool is_simulated =
      places.has_virtual_targets || scenario.mocap.device != DeviceSource::kReal ||
      std::any_of(scenario.robots.begin(), scenario.robots.end(),
                  [](const auto& robot) { return robot.device != DeviceSource::kReal; });
  if (is_simulated && runs(models::kSimPart)) {
    out.push_back({kSimProcess, command("vantage-sim"), true});
  }
  if (scenario.mocap.device != DeviceSource::kDirect && runs(models::kMocapPart)) {
    out.push_back({"vicon", command("vantage-vicon"), true});
  }
  for (const std::string& robot : robots_with_driver(scenario)) {
    if (runs(robot)) {
      add_for(scenario.find_robot(robot)->rover ? "rover" : "quadrotor", robot);
    }
  }
  for (const std::string program : {"sensor", "estimator", "planner"}) {
    for (const models::RobotSpec& robot : scenario.robots) {
      if (runs(robot.name)) {
        add_for(program, robot.name);
      }
    }
  }
  return out;
}

}  // namespace vantage::tools
