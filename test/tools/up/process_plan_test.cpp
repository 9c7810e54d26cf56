#include "tools/up/process_plan.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "scenario/reader/overrides.hpp"

namespace vantage::tools {
namespace {

scenario::Scenario two_robots() {
  scenario::Scenario out;
  out.robots.resize(2);
  out.robots[0].name = "Q1";
  out.robots[1].name = "Q2";
  return out;
}

TEST(ProcessPlan, HasASimulatorAndThreeProcessesPerRobot) {
  const auto plan = process_plan(two_robots(), {"/opt/bin", "s.yaml", "udpm://x", ""});
  ASSERT_EQ(plan.size(), 7U);
  EXPECT_EQ(plan[0].name, "sim");
  EXPECT_EQ(plan[0].arguments, (std::vector<std::string>{"/opt/bin/vantage-sim", "--scenario",
                                                         "s.yaml", "--url", "udpm://x"}));
  EXPECT_EQ(plan[6].name, "planner Q2");
  EXPECT_EQ(plan[6].arguments,
            (std::vector<std::string>{"/opt/bin/vantage-planner", "--scenario", "s.yaml", "--url",
                                      "udpm://x", "--robot", "Q2"}));
}

// Only drivers and the mocap driver get this priority; long computations at this priority would
// block them.
TEST(ProcessPlan, GivesDriversTheGrantedPriority) {
  scenario::Scenario scenario = two_robots();
  scenario.mocap.device = scenario::DeviceSource::kWire;
  scenario.robots[0].device = scenario::DeviceSource::kWire;
  scenario.robots[0].autopilot.emplace();
  scenario.robots[1].device = scenario::DeviceSource::kWire;
  scenario.robots[1].rover.emplace();
  for (const int priority : {0, 50}) {
    ProcessSettings settings{"/opt/bin", "s.yaml", "udpm://x", ""};
    settings.driver_priority = priority;
    int given = 0;
    for (const ProcessSpec& process : process_plan(scenario, settings)) {
      const auto word =
          std::find(process.arguments.begin(), process.arguments.end(), std::string("--fifo"));
      const bool is_driver = process.name == "vicon" || process.name.starts_with("quadrotor ") ||
                             process.name.starts_with("rover ");
      EXPECT_EQ(word != process.arguments.end(), is_driver && priority > 0) << process.name;
      if (word != process.arguments.end()) {
        EXPECT_EQ(*(word + 1), "50");
        ++given;
      }
    }
    EXPECT_EQ(given, priority > 0 ? 3 : 0);
  }
}

TEST(ProcessPlan, StartsNoProcessThatTheUserReplaces) {
  scenario::Scenario scenario = two_robots();
  scenario.robots[0].sensor_publisher = scenario::Publisher::kExternal;
  scenario.planner.publisher = scenario::Publisher::kExternal;
  std::vector<std::string> names;
  for (const ProcessSpec& process :
       process_plan(scenario, {"/opt/bin", "s.yaml", "udpm://x", ""})) {
    names.push_back(process.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"sim", "sensor Q2", "estimator Q1", "estimator Q2"}));
}

// Poses from ROS 2 replace the mocap driver, and the trial ends without them.
TEST(ProcessPlan, StartsTheRos2Bridge) {
  scenario::Scenario scenario = two_robots();
  scenario.mocap.device = scenario::DeviceSource::kReal;
  for (const bool has_poses : {false, true}) {
    scenario.source_text = has_poses ? "ros2: {poses: [{topic: /a, type: tf}]}" : "ros2: {}";
    const auto plan = process_plan(scenario, {"/opt/bin", "s.yaml", "udpm://x", ""});
    const auto named = [&](const std::string& name) {
      return std::find_if(plan.begin(), plan.end(),
                          [&](const ProcessSpec& process) { return process.name == name; });
    };
    ASSERT_NE(named("ros2"), plan.end());
    EXPECT_EQ(named("ros2")->arguments, (std::vector<std::string>{"/opt/bin/vantage", "ros2",
                                                                  "s.yaml", "--url", "udpm://x"}));
    EXPECT_EQ(named("ros2")->is_essential, has_poses);
    EXPECT_EQ(named("vicon") == plan.end(), has_poses);
  }
}

TEST(ProcessPlan, StartsNoSimulatorWhenEveryDeviceIsReal) {
  scenario::Scenario scenario = two_robots();
  scenario.mocap.device = scenario::DeviceSource::kReal;
  for (scenario::RobotSpec& robot : scenario.robots) {
    robot.device = scenario::DeviceSource::kReal;
  }
  const auto plan = process_plan(scenario, {".", "s.yaml", "", ""});
  EXPECT_TRUE(std::none_of(plan.begin(), plan.end(),
                           [](const ProcessSpec& process) { return process.name == "sim"; }));
}

TEST(ProcessPlan, RunsContactJudgeOnMocapHostForRealRobots) {
  scenario::Scenario scenario = two_robots();
  scenario.mocap.device = scenario::DeviceSource::kReal;
  const auto judges_at = [&scenario](const std::string& host) {
    const auto plan = process_plan(scenario, {".", "s.yaml", "", host});
    return std::count_if(plan.begin(), plan.end(), [](const ProcessSpec& process) {
      return process.name == "contacts" && process.arguments.front() == "./vantage-contacts";
    });
  };
  EXPECT_EQ(judges_at(""), 0) << "the simulator judges its own vehicles";
  scenario.robots[1].device = scenario::DeviceSource::kReal;
  EXPECT_EQ(judges_at(""), 1);
  scenario.hosts = {{"LAB", {scenario::kMocapPart}}, {"AIR", {"Q1", "Q2"}}};
  EXPECT_EQ(judges_at("LAB"), 1);
  EXPECT_EQ(judges_at("AIR"), 0);
}

scenario::Scenario on_the_wire() {
  scenario::Scenario scenario = two_robots();
  scenario.mocap.device = scenario::DeviceSource::kWire;
  for (scenario::RobotSpec& robot : scenario.robots) {
    robot.device = scenario::DeviceSource::kWire;
    robot.autopilot.emplace().url = "udp://:14540";
  }
  return scenario;
}

// Poses must arrive within half a second, so drivers and mocap get shorter time limits. The
// simulator does not, because a restarted one begins a new world.
TEST(ProcessPlan, HasShorterTimeLimitsForDriversAndMocap) {
  for (const ProcessSpec& process : process_plan(on_the_wire(), {".", "s.yaml", "", ""})) {
    const bool is_driver = process.name.starts_with("quadrotor ");
    const bool is_close = is_driver || process.name == "vicon";
    EXPECT_EQ(process.patience_s, is_close ? 0.8 : 3.2) << process.name;
    EXPECT_EQ(process.vehicle, is_driver ? process.name.substr(10) : "") << process.name;
  }
}

std::vector<std::string> names_of(const std::vector<ProcessSpec>& plan) {
  std::vector<std::string> out;
  for (const ProcessSpec& process : plan) {
    out.push_back(process.name);
  }
  return out;
}

scenario::Scenario flown_by_px4() {
  scenario::Scenario scenario = on_the_wire();
  scenario.robots.resize(1);
  scenario.robots[0].autopilot->dialect = models::AutopilotDialect::kPx4;
  scenario.robots[0].firmware.emplace().binary = "/bin/sh";
  return scenario;
}

TEST(ProcessPlan, StartsPx4InItsFolderWithParameters) {
  scenario::Scenario scenario = flown_by_px4();
  scenario.robots[0].autopilot->system_id = 7;
  const auto plan =
      process_plan(scenario, {"/opt/bin", "s.yaml", "", "", false, "/var/flights/firmware"});
  const auto found = std::find_if(plan.begin(), plan.end(), [](const ProcessSpec& process) {
    return process.name == "firmware Q1";
  });
  ASSERT_NE(found, plan.end());
  EXPECT_EQ(found->folder, "/var/flights/firmware/Q1");
  const std::vector<std::string>& words = found->arguments;
  const auto has = [&words](const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  EXPECT_EQ(words.front(), "/usr/bin/env");
  EXPECT_TRUE(has("PX4_PARAM_EKF2_EV_CTRL=15"));  // from config/autopilot/px4.params
  EXPECT_TRUE(has("PX4_PARAM_MAV_SYS_ID=7"));
  EXPECT_EQ(std::vector<std::string>(words.end() - 7, words.end()),
            (std::vector<std::string>{"/bin/sh", "-d", "-i", "0", "-w", "/var/flights/firmware/Q1",
                                      "/etc"}));
}

TEST(ProcessPlan, StartsCrazyflieFirmwareWithThePortOfItsInstance) {
  scenario::Scenario scenario = on_the_wire();
  scenario.robots.resize(2);
  for (scenario::RobotSpec& robot : scenario.robots) {
    robot.autopilot.reset();
    robot.crazyflie.emplace().url = "udp://127.0.0.1:19850";
    robot.firmware.emplace().binary = "/bin/sh";
  }
  scenario.robots[0].firmware->instance = 7;
  EXPECT_TRUE(device_faults(scenario).empty());
  const auto plan =
      process_plan(scenario, {"/opt/bin", "s.yaml", "", "", false, "/var/flights/firmware"});
  struct Row {
    std::string name;
    std::string port;
    std::string folder;
  };
  for (const Row& row : {Row{"firmware Q1", "19957", "/var/flights/firmware/Q1"},
                         Row{"firmware Q2", "19951", "/var/flights/firmware/Q2"}}) {
    const auto found = std::ranges::find(plan, row.name, &ProcessSpec::name);
    ASSERT_NE(found, plan.end()) << row.name;
    EXPECT_EQ(found->arguments, (std::vector<std::string>{"/bin/sh", row.port, "127.0.0.1"}));
    EXPECT_EQ(found->folder, row.folder);
  }
  scenario.robots[0].firmware->binary = "no-such-firmware";
  EXPECT_EQ(device_faults(scenario).size(), 1U);
}

TEST(DeviceFaults, NameAnUrlThatPx4DoesNotSupport) {
  scenario::Scenario scenario = flown_by_px4();
  EXPECT_TRUE(device_faults(scenario).empty());
  scenario.robots[0].autopilot->url = "udp://:14541";
  ASSERT_EQ(device_faults(scenario).size(), 1U);
  EXPECT_NE(device_faults(scenario)[0].find("14540"), std::string::npos);
}

TEST(ProcessPlan, StartsADriverPerWireDevice) {
  scenario::Scenario scenario = on_the_wire();
  EXPECT_EQ(names_of(process_plan(scenario, {".", "s.yaml", "", ""})),
            (std::vector<std::string>{"sim", "vicon", "quadrotor Q1", "quadrotor Q2", "sensor Q1",
                                      "sensor Q2", "estimator Q1", "estimator Q2", "planner Q1",
                                      "planner Q2"}));
  scenario.robots[0].device = scenario::DeviceSource::kDirect;
  scenario.mocap.device = scenario::DeviceSource::kDirect;
  const auto mixed = process_plan(scenario, {".", "s.yaml", "", ""});
  EXPECT_EQ(mixed[1].name, "quadrotor Q2");
  EXPECT_EQ(mixed[1].arguments, (std::vector<std::string>{"./vantage-quadrotor", "--scenario",
                                                          "s.yaml", "--url", "", "--robot", "Q2"}));
}

// A simulated camera has a process that writes its images; a camera replaces the sensor.
TEST(ProcessPlan, StartsTheCamerasOfTheRobots) {
  scenario::Overrides overrides;
  const std::string path = VANTAGE_SOURCE_DIR "/config/lab-camera.yaml";
  scenario::Scenario scenario = scenario::load_scenario_with(path, overrides);
  EXPECT_TRUE(device_faults(scenario).empty());
  const std::vector<std::string> simulated = names_of(process_plan(scenario, {".", path, "", ""}));
  for (const char* name : {"camera-emulator Q1", "camera Q1", "camera Q3", "estimator Q1"}) {
    EXPECT_EQ(std::count(simulated.begin(), simulated.end(), name), 1) << name;
  }
  EXPECT_EQ(std::count(simulated.begin(), simulated.end(), "sensor Q1"), 0);
  overrides.keys["robot_defaults.sensor.camera.source"] = "v4l2:/dev/video0";
  scenario = scenario::load_scenario_with(path, overrides);
  const std::vector<std::string> real = names_of(process_plan(scenario, {".", path, "", ""}));
  EXPECT_EQ(std::count(real.begin(), real.end(), "camera Q1"), 1);
  EXPECT_EQ(std::count(real.begin(), real.end(), "camera-emulator Q1"), 0);
}

TEST(ProcessPlan, StartsTheProcessesOfItsHost) {
  scenario::Scenario scenario = on_the_wire();
  scenario.hosts = {{"LAB", {"sim", "Q2"}}, {"AIR", {"Q1"}}};
  EXPECT_EQ(names_of(process_plan(scenario, {".", "s.yaml", "", "LAB"})),
            (std::vector<std::string>{"sim", "vicon", "quadrotor Q2", "sensor Q2", "estimator Q2",
                                      "planner Q2"}))
      << "vicon is not assigned and runs on the first host";
  EXPECT_EQ(names_of(process_plan(scenario, {".", "s.yaml", "", "AIR"})),
            (std::vector<std::string>{"quadrotor Q1", "sensor Q1", "estimator Q1", "planner Q1"}));
  EXPECT_EQ(process_plan(scenario, {".", "s.yaml", "", ""}).size(), 10U) << "all parts on one host";
}

TEST(ProcessPlan, TreatsSimulatorAndMocapDriverAsEssential) {
  for (const ProcessSpec& process : process_plan(on_the_wire(), {".", "s.yaml", "", ""})) {
    EXPECT_EQ(process.is_essential, process.name == "sim" || process.name == "vicon")
        << process.name;
  }
}

TEST(ProcessPlan, StartsTheRoverDriverForARover) {
  scenario::Scenario scenario = on_the_wire();
  scenario.mocap.device = scenario::DeviceSource::kReal;
  scenario.robots[0].device = scenario::DeviceSource::kReal;
  scenario.robots[0].autopilot.reset();
  scenario.robots[0].rover.emplace().url = "udpout://10.0.0.7:7700";
  EXPECT_TRUE(device_faults(scenario).empty());
  const auto names = names_of(process_plan(scenario, {".", "s.yaml", "", ""}));
  EXPECT_NE(std::find(names.begin(), names.end(), "rover Q1"), names.end());
  EXPECT_EQ(std::find(names.begin(), names.end(), "quadrotor Q1"), names.end());
  scenario.robots[0].device = scenario::DeviceSource::kWire;
  EXPECT_TRUE(device_faults(scenario).empty());
  const auto on_wire = names_of(process_plan(scenario, {".", "s.yaml", "", ""}));
  EXPECT_NE(std::find(on_wire.begin(), on_wire.end(), "rover Q1"), on_wire.end());
  EXPECT_NE(std::find(on_wire.begin(), on_wire.end(), "sim"), on_wire.end());
}

TEST(DeviceFaults, NameUnobservedRealRobotAndDriverWithoutAutopilot) {
  scenario::Scenario scenario = on_the_wire();
  EXPECT_TRUE(device_faults(scenario).empty());
  scenario.robots[1].device = scenario::DeviceSource::kReal;
  EXPECT_EQ(device_faults(scenario).size(), 1u);
  scenario.mocap.device = scenario::DeviceSource::kReal;
  EXPECT_TRUE(device_faults(scenario).empty());
  scenario.robots[0].autopilot.reset();
  EXPECT_EQ(device_faults(scenario).size(), 1u);
}

}  // namespace
}  // namespace vantage::tools
