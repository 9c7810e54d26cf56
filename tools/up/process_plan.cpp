#include "tools/up/process_plan.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/result.hpp"
#include "scenario/reader/camera_yaml.hpp"
#include "scenario/reader/scenario_ros2_yaml.hpp"
#include "scenario/vehicle_kinds.hpp"
#include "trial/robot_processes.hpp"
#include "wire/autopilot/parameter_rules.hpp"
#include "wire/crtp/link_uri.hpp"

namespace vantage::tools {

namespace {

using scenario::DeviceSource;

bool has_driver(const scenario::RobotSpec& robot) { return robot.device != DeviceSource::kDirect; }

constexpr const char* kDriverWaits = "udp://";
// Geographic origin that the driver sends to autopilots; see sim/firmware/firmware_sensors.
constexpr const char* kArdupilotHome = "39.9522,-75.1932,10,0";

/// Returns the path of an executable; empty if there is none. Makes a name with a slash absolute
/// and searches other names in PATH.
std::string find_program(const std::string& name) {
  std::vector<std::string> candidates;
  if (name.find('/') != std::string::npos) {
    candidates.push_back(std::filesystem::absolute(name).string());
  } else {
    std::istringstream folders(std::getenv("PATH") != nullptr ? std::getenv("PATH") : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
      // Firmware is started in another working folder.
      candidates.push_back(std::filesystem::absolute(folder + "/" + name).string());
    }
  }
  const auto found =
      std::find_if(candidates.begin(), candidates.end(), [](const std::string& path) {
        std::error_code unreadable;
        return ::access(path.c_str(), X_OK) == 0 &&
               !std::filesystem::is_directory(path, unreadable);
      });
  return found == candidates.end() ? "" : *found;
}

std::string absolute(const std::string& path) {
  return path.empty() ? path : std::filesystem::absolute(path).string();
}

/// Returns the program that `vantage up` starts for the robot; empty if there is none.
const std::string& firmware_binary(const scenario::RobotSpec& robot) {
  static const std::string none;
  return robot.firmware ? robot.firmware->binary : none;
}

/// Returns the UDP port at which the robot's driver waits for its autopilot.
Result<int> driver_port(const scenario::RobotSpec& robot) {
  const std::string& url = robot.autopilot->url;
  const std::string refusal = "robot " + robot.name +
                              ": autopilot.url must be udp://[HOST]:PORT because the robot has "
                              "`firmware`, is '" +
                              url + "'";
  if (!url.starts_with(kDriverWaits)) {
    return Error{refusal};
  }
  const Result<HostAndPort> address = split_address(url.substr(std::strlen(kDriverWaits)));
  return address.ok() ? Result<int>(address.value().port) : Result<int>(Error{refusal});
}

// Parameters of the simulated airframe; wire::parameter_file() contains the other parameters.
constexpr const char* kArdupilotAirframe =
    "FRAME_CLASS 1\nFRAME_TYPE 1\nATC_ACCEL_Y_MAX 30000\nLOG_BACKEND_TYPE 0\n"
    "BATT_MONITOR 4\nBATT_CAPACITY 5600\nBATT_VOLT_PIN 13\nBATT_CURR_PIN 12\n"
    "BATT_VOLT_MULT 10.1\nBATT_AMP_PERVLT 17\n"
    "SIM_VIB_MOT_MASK 15\n";  // motors that load the simulated battery; the default is none

ProcessSpec ardupilot_process(const scenario::RobotSpec& robot, int instance, int system_id,
                              const ProcessSettings& settings) {
  ProcessSpec out{
      "firmware " + robot.name,
      {find_program(robot.firmware->binary), "--wipe", "--instance", std::to_string(instance),
       "--model", "JSON:127.0.0.1", "--home", kArdupilotHome, "--sysid", std::to_string(system_id),
       "--serial0", fmt::format("udpclient:127.0.0.1:{}", driver_port(robot).value())}};
  std::string defaults = absolute(robot.firmware->parameters);
  if (defaults.empty()) {
    defaults = "parameters.parm";
    out.files[defaults] = kArdupilotAirframe +
                          std::string(wire::parameter_file(models::AutopilotDialect::kArdupilot));
  }
  out.arguments.insert(out.arguments.end(), {"--defaults", defaults});
  out.folder = absolute(settings.firmware_folder) + "/" + robot.name;
  out.end_signal = SIGKILL;  // ArduPilot ignores other signals when its simulator has ended
  return out;
}

constexpr int kPx4Port = 14'540;  // UDP port to which instance 0 sends; instance n adds n

// Parameters of the simulated airframe (sim/firmware/multirotor); wire::parameter_file() contains
// the other parameters.
constexpr std::array kPx4Airframe{
    "PX4_PARAM_CA_ROTOR0_PX=0.12",  "PX4_PARAM_CA_ROTOR0_PY=0.12",  "PX4_PARAM_CA_ROTOR0_KM=0.016",
    "PX4_PARAM_CA_ROTOR1_PX=-0.12", "PX4_PARAM_CA_ROTOR1_PY=-0.12", "PX4_PARAM_CA_ROTOR1_KM=0.016",
    "PX4_PARAM_CA_ROTOR2_PX=0.12",  "PX4_PARAM_CA_ROTOR2_PY=-0.12", "PX4_PARAM_CA_ROTOR2_KM=-0.016",
    "PX4_PARAM_CA_ROTOR3_PX=-0.12", "PX4_PARAM_CA_ROTOR3_PY=0.12",  "PX4_PARAM_CA_ROTOR3_KM=-0.016",
    "PX4_PARAM_THR_MDL_FAC=0.65",   "PX4_PARAM_MPC_THR_HOVER=0.41", "PX4_PARAM_BAT1_N_CELLS=3",
    "PX4_PARAM_MC_YAWRATE_P=0.5",   "PX4_PARAM_SIM_BAT_DRAIN=900",  "PX4_PARAM_SIM_BAT_MIN_PCT=0",
    "PX4_PARAM_SDLOG_BACKEND=0"};

/// Converts lines "NAME VALUE" into the environment variables that PX4's start-up script reads.
std::vector<std::string> px4_settings(std::istream& text) {
  std::vector<std::string> out;
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string name;
    std::string value;
    if (words >> name >> value) {
      out.push_back(fmt::format("PX4_PARAM_{}={}", name, value));
    }
  }
  return out;
}

ProcessSpec px4_process(const scenario::RobotSpec& robot, int instance, int system_id,
                        const ProcessSettings& settings) {
  const std::string binary = find_program(robot.firmware->binary);
  ProcessSpec out{"firmware " + robot.name, {"/usr/bin/env", "PX4_SIM_MODEL=none_iris"}};
  out.folder = absolute(settings.firmware_folder) + "/" + robot.name;
  std::vector<std::string>& words = out.arguments;
  words.insert(words.end(), kPx4Airframe.begin(), kPx4Airframe.end());
  std::ifstream file(robot.firmware->parameters);
  std::istringstream ours(wire::parameter_file(models::AutopilotDialect::kPx4));
  for (const std::string& setting :
       robot.firmware->parameters.empty() ? px4_settings(ours) : px4_settings(file)) {
    words.push_back(setting);
  }
  // The start-up files are in ../etc of the program's folder. Without -d PX4 needs a terminal.
  const std::filesystem::path start_up =
      std::filesystem::path(binary).parent_path().parent_path() / "etc";
  words.insert(words.end(), {fmt::format("PX4_PARAM_MAV_SYS_ID={}", system_id), binary, "-d", "-i",
                             std::to_string(instance), "-w", out.folder, start_up.string()});
  return out;
}

// The firmware sends hello packets to this port until the simulator answers
// (wire/sitl/crazyflie_sensors).
constexpr int kCrazyflieHelloPort = 19'950;  // port of instance 0; instance n adds n

ProcessSpec crazyflie_process(const scenario::RobotSpec& robot, int instance,
                              const ProcessSettings& settings) {
  ProcessSpec out{"firmware " + robot.name,
                  {find_program(robot.firmware->binary),
                   std::to_string(kCrazyflieHelloPort + instance), "127.0.0.1"}};
  out.folder = absolute(settings.firmware_folder) + "/" + robot.name;
  return out;
}

ProcessSpec firmware_process(const scenario::RobotSpec& robot, int instance,
                             const ProcessSettings& settings) {
  if (robot.crazyflie) {
    return crazyflie_process(robot, instance, settings);
  }
  const int system_id = robot.autopilot->system_id > 0 ? robot.autopilot->system_id : instance + 1;
  return robot.autopilot->dialect == models::AutopilotDialect::kPx4
             ? px4_process(robot, instance, system_id, settings)
             : ardupilot_process(robot, instance, system_id, settings);
}

/// Adds the faults that prevent the driver of a MAVLink robot with firmware from reaching the
/// autopilot.
void add_port_faults(const scenario::RobotSpec& robot, int instance,
                     std::vector<std::string>& out) {
  const auto port = driver_port(robot);
  if (!port.ok()) {
    out.push_back(port.error().message);
  } else if (const int theirs = kPx4Port + instance;
             robot.autopilot->dialect == models::AutopilotDialect::kPx4 && port.value() != theirs) {
    out.push_back(
        fmt::format("robot {}: instance {} of PX4 sends to port {}, but `url` has port {}",
                    robot.name, instance, theirs, port.value()));
  }
}

}  // namespace

std::vector<std::string> robots_with_driver(const scenario::Scenario& scenario) {
  std::vector<std::string> out;
  for (const scenario::RobotSpec& robot : scenario.robots) {
    if (has_driver(robot)) {
      out.push_back(robot.name);
    }
  }
  return out;
}

std::vector<std::string> device_faults(const scenario::Scenario& scenario) {
  std::vector<std::string> out;
  for (const scenario::CameraSpec& camera : scenario::cameras_of(scenario)) {
    const scenario::RobotSpec& robot = *scenario.find_robot(camera.robot);
    if (camera.source == scenario::kSimulatedSource && robot.device == DeviceSource::kReal) {
      out.push_back("robot " + robot.name +
                    " is real, but its camera is simulated: set source to v4l2:DEVICE or "
                    "folder:PATH");
    }
  }
  for (const scenario::RobotSpec& robot : scenario.robots) {
    const bool is_real = robot.device == DeviceSource::kReal;
    if (is_real && scenario.mocap.device != DeviceSource::kReal) {
      out.push_back("robot " + robot.name +
                    " is real, but mocap is simulated and cannot measure it: "
                    "set mocap.device to 'real'");
    }
    const scenario::VehicleKind* kind = scenario::vehicle_kind(robot);
    if (has_driver(robot) && (kind == nullptr || kind->url(robot)->empty())) {
      out.push_back("robot " + robot.name + " has device '" + (is_real ? "real" : "wire") +
                    "' but no address: add " + scenario::vehicle_sections(" or ") +
                    " with a `url`");
    }
    if (robot.crazyflie && has_driver(robot)) {
      if (const auto uri = wire::crtp::parse_link_uri(robot.crazyflie->url); !uri.ok()) {
        out.push_back("robot " + robot.name + ": crazyflie.url " + uri.error().message);
      }
    }
    if (!firmware_binary(robot).empty()) {
      if (robot.autopilot) {
        add_port_faults(robot, scenario.firmware_instance(robot), out);
      }
      if (find_program(robot.firmware->binary).empty()) {
        out.push_back(
            "robot " + robot.name + ": firmware.binary '" + robot.firmware->binary +
            "' is not a program on this host; docs/guide/firmware.md explains how to get one");
      }
    }
  }
  return out;
}

// Long function: it adds the kinds of processes one by one.
std::vector<ProcessSpec> process_plan(const scenario::Scenario& scenario,
                                      const ProcessSettings& settings) {
  const auto command = [&settings](const std::string& program) {
    return std::vector<std::string>{settings.executables + "/" + program, "--scenario",
                                    settings.scenario_path, "--url", settings.url};
  };
  const auto runs = [&](const std::string& part) {
    return settings.host.empty() || scenario.runs_on(settings.host, part);
  };
  std::vector<ProcessSpec> out;
  const auto ours = [&](const std::string& name, const std::string& program, double patience_s) {
    ProcessSpec process{name, command(program)};
    process.patience_s = patience_s;
    process.keep_open = settings.keep_open;
    return process;
  };
  const auto add_for = [&](const std::string& program, const std::string& robot,
                           double patience_s = kPatienceS) -> ProcessSpec& {
    ProcessSpec process =
        ours(trial::process_name(program, robot), "vantage-" + program, patience_s);
    process.arguments.insert(process.arguments.end(), {"--robot", robot});
    out.push_back(std::move(process));
    return out.back();
  };
  const auto give_priority = [&](ProcessSpec& process) {
    if (settings.driver_priority > 0) {
      process.arguments.insert(process.arguments.end(),
                               {"--fifo", std::to_string(settings.driver_priority)});
    }
  };
  const bool is_simulated =
      settings.has_virtual_targets || scenario.mocap.device != DeviceSource::kReal ||
      std::any_of(scenario.robots.begin(), scenario.robots.end(),
                  [](const auto& robot) { return robot.device != DeviceSource::kReal; });
  if (is_simulated && runs(scenario::kSimPart)) {
    out.push_back(ours(kSimProcess, "vantage-sim", kPatienceS));
    out.back().is_essential = true;
  }
  for (const scenario::RobotSpec& robot : scenario.robots) {
    if (!firmware_binary(robot).empty() && runs(scenario::kSimPart)) {
      out.push_back(firmware_process(robot, scenario.firmware_instance(robot), settings));
    }
  }
  const std::optional<scenario::Ros2Spec> ros2 = scenario::ros2_of(scenario);
  const bool has_ros2_poses = ros2 && !ros2->poses.empty();
  if (ros2 && runs(scenario::kMocapPart)) {
    ProcessSpec process{
        "ros2",
        {settings.executables + "/vantage", "ros2", settings.scenario_path, "--url", settings.url}};
    process.patience_s = has_ros2_poses ? kDriverPatienceS : kPatienceS;
    process.keep_open = settings.keep_open;
    process.is_essential = has_ros2_poses;
    out.push_back(std::move(process));
  }
  if (scenario.mocap.device != DeviceSource::kDirect && !has_ros2_poses &&
      runs(scenario::kMocapPart)) {
    const std::string driver = scenario.mocap.protocol.driver();
    out.push_back(ours(driver, "vantage-" + driver, kDriverPatienceS));
    out.back().is_essential = true;
    give_priority(out.back());
  }
  const bool has_real_robots =
      std::any_of(scenario.robots.begin(), scenario.robots.end(),
                  [](const auto& robot) { return robot.device == DeviceSource::kReal; });
  if (has_real_robots && runs(scenario::kMocapPart)) {
    out.push_back(ours("contacts", "vantage-contacts", kPatienceS));
  }
  for (const std::string& robot : robots_with_driver(scenario)) {
    if (runs(robot)) {
      const scenario::VehicleKind* kind = scenario::vehicle_kind(*scenario.find_robot(robot));
      const std::string driver(kind != nullptr ? kind->driver : "quadrotor");
      add_for(driver, robot, kDriverPatienceS).vehicle = robot;  // a driver without address exits
      give_priority(out.back());
    }
  }
  for (const scenario::CameraSpec& camera : scenario::cameras_of(scenario)) {
    if (runs(camera.robot)) {
      if (camera.source == scenario::kSimulatedSource) {
        add_for("camera-emulator", camera.robot);
      }
      add_for("camera", camera.robot);
    }
  }
  for (const char* const program : trial::kProcessOrder) {
    for (const scenario::RobotSpec& robot : scenario.robots) {
      const std::vector<std::string> own = trial::own_processes(scenario, robot);
      if (runs(robot.name) && std::find(own.begin(), own.end(), program) != own.end()) {
        add_for(program, robot.name);
      }
    }
  }
  return out;
}

}  // namespace vantage::tools
