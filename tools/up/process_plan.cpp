#include "tools/up/process_plan.hpp"

#include <algorithm>

namespace vantage::tools {

std::vector<ProcessSpec> process_plan(const models::Scenario& scenario,
                                      const ProcessPlaces& places) {
  const auto command = [&places](const std::string& program) {
    return std::vector<std::string>{places.executables + "/" + program, "--scenario",
                                    places.scenario_path, "--url", places.url};
  };
  std::vector<ProcessSpec> out;
  const bool is_simulated =
      scenario.mocap.device != models::DeviceSource::kReal ||
      std::any_of(scenario.robots.begin(), scenario.robots.end(),
                  [](const auto& robot) { return robot.device != models::DeviceSource::kReal; });
  if (is_simulated) {
    out.push_back({"sim", command("vantage-sim")});
  }
  for (const std::string program : {"sensor", "estimator", "planner"}) {
    for (const models::RobotSpec& robot : scenario.robots) {
      ProcessSpec process{program + " " + robot.name, command("vantage-" + program)};
      process.arguments.insert(process.arguments.end(), {"--robot", robot.name});
      out.push_back(std::move(process));
    }
  }
  return out;
}

ProcessSpec logger_process(const std::string& url, const std::string& log_path) {
  return {"lcm-logger", {"lcm-logger", "--quiet", "--force", "--lcm-url=" + url, log_path}};
}

}  // namespace vantage::tools
