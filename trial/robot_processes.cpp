#include "trial/robot_processes.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

#include <fmt/format.h>

#include "core/check.hpp"

namespace vantage::trial {

namespace {

bool is_external(const scenario::Scenario& scenario, const scenario::RobotSpec& robot,
                 std::string_view process) {
  const scenario::Publisher publisher = process == "sensor"      ? robot.sensor_publisher
                                        : process == "estimator" ? scenario.estimator.publisher
                                                                 : scenario.planner.publisher;
  return publisher == scenario::Publisher::kExternal;
}

}  // namespace

std::vector<std::string> own_processes(const scenario::Scenario& scenario,
                                       const scenario::RobotSpec& robot) {
  std::vector<std::string> out;
  for (const char* process : kRobotProcesses) {
    if (!is_external(scenario, robot, process)) {
      out.emplace_back(process);
    }
  }
  return out;
}

void require_own_processes(const scenario::Scenario& scenario) {
  for (const scenario::RobotSpec& robot : scenario.robots) {
    for (const char* process : kRobotProcesses) {
      if (is_external(scenario, robot, process)) {
        throw StartupError(fmt::format(
            "{}: robot {} has an external {} (`device: external`), and this command runs no other "
            "processes; use `vantage up`, or set {}.device=vantage",
            scenario.name, robot.name, process, process));
      }
    }
  }
}

std::string process_name(const std::string& word, const std::string& robot) {
  return word + " " + robot;
}

std::string node_name(std::string process) {
  std::transform(process.begin(), process.end(), process.begin(), [](unsigned char c) {
    return c == ' ' ? '_' : static_cast<char>(std::toupper(c));
  });
  return process;
}

}  // namespace vantage::trial
