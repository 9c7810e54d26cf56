#include "trial/robot_processes.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

#include <fmt/format.h>

#include "core/check.hpp"
#include "scenario/reader/camera_yaml.hpp"
#include "scenario/reader/localizer_yaml.hpp"

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
  const auto localizer = scenario::localizer_of(scenario);
  if (localizer && scenario::index_of(*localizer, robot.name) >= 0) {
    out.emplace_back(kLocalizerProcess);
  }
  for (const char* process : kRobotProcesses) {
    if (!is_external(scenario, robot, process)) {
      out.emplace_back(process);
    }
  }
  return out;
}

void require_own_processes(const scenario::Scenario& scenario) {
  const std::vector<scenario::CameraSpec> cameras = scenario::cameras_of(scenario);
  for (const scenario::RobotSpec& robot : scenario.robots) {
    const auto camera = std::find_if(cameras.begin(), cameras.end(),
                                     [&](const auto& each) { return each.robot == robot.name; });
    const bool has_camera = camera != cameras.end();
    if (has_camera && camera->source != scenario::kSimulatedSource) {
      throw StartupError(fmt::format(
          "{}: the camera of {} has the source {}, and this command simulates cameras; use "
          "`vantage up`, or set robot_defaults.sensor.camera.source=simulated",
          scenario.name, robot.name, camera->source));
    }
    for (const char* process : kRobotProcesses) {
      const bool is_simulated = has_camera && process == std::string_view("sensor");
      if (!is_simulated && is_external(scenario, robot, process)) {
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
    return c == ' ' || c == '-' ? '_' : static_cast<char>(std::toupper(c));
  });
  return process;
}

}  // namespace vantage::trial
