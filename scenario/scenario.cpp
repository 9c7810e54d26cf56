#include "scenario/scenario.hpp"

#include <algorithm>

namespace vantage::scenario {
const char* name_of(TrialMode mode) {
  switch (mode) {
    case TrialMode::kLive:
      return "live";
    case TrialMode::kWire:
      return "wire";
    case TrialMode::kSimulation:
      return "simulation";
    case TrialMode::kReplay:
      return "replay";
  }
  return "unknown";
}

TrialMode trial_mode(const Scenario& scenario) {
  const auto has = [&](DeviceSource source) {
    return scenario.mocap.device == source ||
           std::any_of(scenario.robots.begin(), scenario.robots.end(),
                       [source](const RobotSpec& robot) { return robot.device == source; });
  };
  if (has(DeviceSource::kReal)) {
    return TrialMode::kLive;
  }
  return has(DeviceSource::kWire) ? TrialMode::kWire : TrialMode::kSimulation;
}

const RobotSpec* Scenario::find_robot(const std::string& robot) const {
  const auto found = std::find_if(robots.begin(), robots.end(),
                                  [&](const RobotSpec& spec) { return spec.name == robot; });
  return found == robots.end() ? nullptr : &*found;
}

bool Scenario::runs_on(const std::string& host, const std::string& part) const {
  const auto names = [&](const HostSpec& spec) {
    return std::find(spec.runs.begin(), spec.runs.end(), part) != spec.runs.end();
  };
  const auto runner = std::find_if(hosts.begin(), hosts.end(), names);
  return hosts.empty() || (runner == hosts.end() ? hosts.front() : *runner).name == host;
}

int Scenario::firmware_instance(const RobotSpec& robot) const {
  const bool is_given = robot.firmware && robot.firmware->instance;
  return is_given ? *robot.firmware->instance : static_cast<int>(&robot - robots.data());
}

}  // namespace vantage::scenario
