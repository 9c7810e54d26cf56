#include <algorithm>
#include <chrono>

#include <gtest/gtest.h>

#include "bus/bus.hpp"
#include "bus/scenario_yaml.hpp"
#include "bus/transport.hpp"
#include "tools/check/arming_watch.hpp"
#include "tools/check/preflight.hpp"
#include "tools/console/console.hpp"

namespace vantage::tools {
namespace {

using models::OperatorAction;
constexpr Time kStart = from_utime(1'700'000'000'000'000);

models::Scenario lab() { return bus::load_scenario(VANTAGE_SOURCE_DIR "/config/lab.yaml"); }

bool mentions(const std::vector<std::string>& lines, const std::string& words) {
  return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
    return line.find(words) != std::string::npos;
  });
}

TEST(OperatorDesk, RefusesTheSecondStationEverythingButTheEmergencyStop) {
  bus::InProcessHub hub;
  const auto link_a = hub.connect();
  const auto link_b = hub.connect();
  const auto link_v = hub.connect();
  bus::Bus bus_a(*link_a, 11);
  bus::Bus bus_b(*link_b, 12);
  bus::Bus vehicle(*link_v, 13);
  std::vector<models::OperatorCommand> heard;
  vehicle.subscribe<models::OperatorCommand>(
      bus::kCommand, [&](const models::OperatorCommand& command) { heard.push_back(command); });
  OperatorDesk first(bus_a, false, kStart);
  std::optional<OperatorDesk> second;
  for (int i = 0; i < 40; ++i) {
    const Time now = kStart + from_seconds(0.1 * i);
    if (i == 20) {
      second.emplace(bus_b, false, now);
    }
    for (bus::Bus* each : {&bus_a, &bus_b, &vehicle}) {
      each->handle(std::chrono::microseconds(0));
    }
    (void)first.tick(now);
    if (second) {
      (void)second->tick(now);
    }
  }
  const Time now = kStart + from_seconds(4.0);
  EXPECT_TRUE(first.send(now, OperatorAction::kArm, ""));
  EXPECT_FALSE(second->send(now, OperatorAction::kArm, ""));
  EXPECT_FALSE(second->send(now, OperatorAction::kHold, ""));
  EXPECT_TRUE(second->send(now, OperatorAction::kEmergencyStop, ""));
  EXPECT_TRUE(first.send(now, OperatorAction::kEmergencyStop, ""));
  vehicle.handle(std::chrono::microseconds(0));
  const auto count = [&](std::int64_t run, OperatorAction action) {
    return std::count_if(heard.begin(), heard.end(), [&](const models::OperatorCommand& command) {
      return command.stamp.run_id == run && command.action == action;
    });
  };
  EXPECT_GT(count(11, OperatorAction::kHeartbeat), 10);
  EXPECT_EQ(count(12, OperatorAction::kHeartbeat), 0);
  EXPECT_EQ(count(12, OperatorAction::kArm), 0);
  EXPECT_EQ(count(12, OperatorAction::kEmergencyStop), 1) << "both stops arrive";
  EXPECT_EQ(count(11, OperatorAction::kEmergencyStop), 1);
}

// A console with a wrong clock is heard: what it says is stamped by the vehicles' clock.
TEST(OperatorDesk, SpeaksInTheVehiclesTime) {
  for (const Duration off : {Duration(-std::chrono::hours(24)), Duration(std::chrono::hours(1)),
                             Duration(std::chrono::milliseconds(300))}) {
    bus::InProcessHub hub;
    const auto link_desk = hub.connect();
    const auto link_vehicle = hub.connect();
    bus::Bus desk_bus(*link_desk, 11);
    bus::Bus vehicle(*link_vehicle, 13);
    std::vector<models::OperatorCommand> heard;
    vehicle.subscribe<models::OperatorCommand>(
        bus::kCommand, [&](const models::OperatorCommand& command) { heard.push_back(command); });
    OperatorDesk desk(desk_bus, false, kStart + off);
    Time now = kStart;
    for (int i = 0; i < 30; ++i) {
      now = kStart + from_seconds(0.1 * i);
      models::VehicleStatus status;
      status.robot = "Q1";
      status.stamp.time = now;
      vehicle.publish(bus::quadrotor_channel("Q1"), status);
      desk_bus.handle(std::chrono::microseconds(0));
      (void)desk.tick(now + off);
    }
    heard.clear();
    EXPECT_TRUE(desk.send(now + off, OperatorAction::kEmergencyStop, ""));
    vehicle.handle(std::chrono::microseconds(0));
    ASSERT_FALSE(heard.empty());
    EXPECT_TRUE(std::any_of(heard.begin(), heard.end(), [&](const auto& command) {
      return command.action == OperatorAction::kEmergencyStop &&
             std::chrono::abs(command.stamp.time - now) <= std::chrono::milliseconds(300);
    }));
  }
}

TEST(ArmingWatch, SaysWhatIsMissingAndWhatTheDriversSay) {
  bus::InProcessHub hub;
  const auto link = hub.connect();
  const auto link_watch = hub.connect();
  bus::Bus lab_bus(*link, 1);
  bus::Bus watch_bus(*link_watch, 2);
  const models::Scenario scenario = lab();
  const ArmingWatch watch(watch_bus, scenario);
  EXPECT_TRUE(mentions(watch.blocks(), "no mocap frame"));
  EXPECT_TRUE(mentions(watch.blocks(), "no operator's heartbeat"));

  models::MocapFrame frame;
  frame.stamp.time = frame.arrival = kStart;
  for (const models::RobotSpec& robot : scenario.robots) {
    models::MocapBody body;
    body.name = robot.name;
    body.occluded = robot.name == "Q2";
    frame.bodies.push_back(body);
    models::VehicleStatus status;
    status.stamp.time = kStart;
    status.robot = robot.name;
    if (robot.name == "Q3") {
      status.reasons = {"battery for take-off"};
    }
    lab_bus.publish(bus::quadrotor_channel(robot.name), status);
  }
  lab_bus.publish(bus::kVicon, frame);
  models::OperatorCommand beat;
  beat.stamp.time = kStart;
  lab_bus.publish(bus::kCommand, beat);
  watch_bus.handle(std::chrono::microseconds(0));
  const std::vector<std::string> blocks = watch.blocks();
  EXPECT_EQ(blocks.size(), 2U);
  EXPECT_TRUE(mentions(blocks, "Q2: mocap shows no body"));
  EXPECT_TRUE(mentions(blocks, "Q3: battery for take-off"));
}

TEST(CheckPreflight, RefusesWhatFlightSafetyWouldRefuseInFlight) {
  models::Scenario scenario = lab();
  scenario.planner.separation_m = 0.5;  // two radii
  EXPECT_TRUE(mentions(check_preflight(scenario).faults, "touch at that distance"));
  scenario = lab();
  scenario.robots[1].primitives.push_back({1.0, 20.0});
  EXPECT_TRUE(mentions(check_preflight(scenario).faults, "robot Q2: flight safety refuses"));
  scenario = lab();
  scenario.robots[2].height_m = scenario.world.ceiling_m;
  EXPECT_TRUE(mentions(check_preflight(scenario).faults, "below the ceiling"));
}

}  // namespace
}  // namespace vantage::tools
