#include "tools/up/process_plan.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>

#include <fmt/format.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/result.hpp"

namespace vantage::tools {

namespace {

using models::DeviceSource;

bool has_driver(const models::RobotSpec& robot) { return robot.device != DeviceSource::kDirect; }

constexpr const char* kDriverWaits = "udp://";
// Where the driver tells autopilots that they are; see sim/firmware/firmware_sensors.
constexpr const char* kArdupilotHome = "39.9522,-75.1932,10,0";

/// A program's whole path: as it is, or where PATH has it; empty when there is none.
std::string find_program(const std::string& name) {
  std::vector<std::string> places;
  if (name.find('/') != std::string::npos) {
    places.push_back(std::filesystem::absolute(name).string());
  } else {
    std::istringstream folders(std::getenv("PATH") != nullptr ? std::getenv("PATH") : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
      places.push_back(folder + "/" + name);
    }
  }
  const auto found = std::find_if(places.begin(), places.end(), [](const std::string& place) {
    return ::access(place.c_str(), X_OK) == 0;
  });
  return found == places.end() ? "" : *found;
}

std::string absolute(const std::string& path) {
  return path.empty() ? path : std::filesystem::absolute(path).string();
}

/// The port at which the driver waits for its autopilot.
Result<int> driver_port(const models::RobotSpec& robot) {
  const std::string& url = robot.autopilot->url;
  const std::string refusal = "robot " + robot.name +
                              " has `firmware`, which speaks to its driver: `url` must be "
                              "udp://[HOST]:PORT, is '" + url + "'";
  if (!url.starts_with(kDriverWaits)) {
    return Error{refusal};
  }
  const Result<HostAndPort> address = split_address(url.substr(std::strlen(kDriverWaits)));
  return address.ok() ? Result<int>(address.value().port) : Result<int>(Error{refusal});
}

ProcessSpec ardupilot_process(const models::RobotSpec& robot, int instance, int system_id,
                              const ProcessPlaces& places) {
  ProcessSpec out{"firmware " + robot.name,
                  {find_program(robot.firmware->binary), "--wipe", "--instance",
                   std::to_string(instance), "--model", "JSON:127.0.0.1", "--home", kArdupilotHome,
                   "--sysid", std::to_string(system_id), "--serial0",
                   fmt::format("udpclient:127.0.0.1:{}", driver_port(robot).value())}};
  if (!robot.firmware->parameters.empty()) {
    out.arguments.insert(out.arguments.end(),
                         {"--defaults", absolute(robot.firmware->parameters)});
  }
  out.folder = absolute(places.firmware_folder) + "/" + robot.name;
  out.end_signal = SIGKILL;  // it hears no other when its simulator has gone
  return out;
}

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
    if (robot.firmware && !robot.firmware->binary.empty()) {
      if (const auto port = driver_port(robot); !port.ok()) {
        out.push_back(port.error().message);
      }
      if (find_program(robot.firmware->binary).empty()) {
        out.push_back("robot " + robot.name + ": firmware.binary '" + robot.firmware->binary +
                      "' is no program here; docs/firmware.md says how to get one");
      }
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
  for (const models::RobotSpec& robot : scenario.robots) {
    if (robot.firmware && !robot.firmware->binary.empty() && runs(models::kSimPart)) {
      const int instance = scenario.firmware_instance(robot);
      const int system_id =
          robot.autopilot->system_id > 0 ? robot.autopilot->system_id : instance + 1;
      out.push_back(ardupilot_process(robot, instance, system_id, places));
    }
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
