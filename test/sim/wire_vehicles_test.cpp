// Tests robots simulated at the other end of a device connection: their kinds, limits and counters.

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/check.hpp"
#include "scenario/vehicle_kinds.hpp"
#include "sim/app/wire_firmware.hpp"
#include "sim/app/wire_kinds.hpp"
#include "sim/app/wire_quadrotor.hpp"
#include "sim/app/wire_rover.hpp"
#include "test/sim/lab_scenario.hpp"
#include "test/support/udp_port.hpp"
#include "wire/mavlink/constants.hpp"
#include "wire/mavlink/messages.hpp"
#include "wire/rover/packet.hpp"

namespace vantage::sim {
namespace {

using test::port_of_this_test;

constexpr Time kStart = from_utime(1'700'000'000'003'000);

std::map<std::string, std::int64_t> counts_of(const WireVehicle& vehicle) {
  std::map<std::string, std::int64_t> out;
  for (const models::NamedCount& counter : vehicle.counters()) {
    out[counter.name] = counter.count;
  }
  return out;
}

scenario::RobotSpec flier_at(const std::string& port) {
  scenario::RobotSpec robot = test::lab_scenario().robots[1];
  robot.autopilot.emplace();
  robot.autopilot->url = "udpout://127.0.0.1:" + port;
  return robot;
}

/// A driver that sends MAVLink messages first.
struct Driver {
  explicit Driver(const std::string& port) : socket("udp://127.0.0.1:" + port) {}
  template <class Message>
  void send(const Message& message) {
    std::vector<std::uint8_t> bytes;
    wire::mavlink::append_bytes(wire::mavlink::pack(message, {255, 191, sequence++}), bytes);
    socket.write(bytes);
  }
  std::vector<wire::mavlink::Frame> receive_frames() {
    std::vector<wire::mavlink::Frame> out;
    socket.read_each([&](auto bytes, Time) {
      parser.feed(bytes, [&](const wire::mavlink::Frame& frame) { out.push_back(frame); });
    });
    return out;
  }
  VehicleSocket socket;
  wire::mavlink::Parser parser;
  std::uint8_t sequence = 0;
};

TEST(WireQuadrotor, HasTheScenariosSystemIdOrItsIndex) {
  for (const int named : {0, 42}) {
    const std::string port = port_of_this_test(0);
    scenario::RobotSpec robot = flier_at(port);
    robot.autopilot->system_id = named;
    robot.autopilot->dialect = models::AutopilotDialect::kArdupilot;
    WireQuadrotor vehicle(robot, {}, 7, 1, kStart);
    EXPECT_EQ(vehicle.name(), "Q2");
    EXPECT_EQ(vehicle.radius_m(), robot.limits.radius_m);
    Driver driver(port);
    driver.send(wire::mavlink::Heartbeat{});
    vehicle.step(kStart, 0.005);
    vehicle.exchange(kStart + Duration{5'000});
    const auto frames = driver.receive_frames();
    ASSERT_FALSE(frames.empty());
    EXPECT_EQ(frames[0].origin.system_id, named == 0 ? 7 : 42);
    const auto heartbeat = wire::mavlink::unpack<wire::mavlink::Heartbeat>(frames[0]);
    ASSERT_TRUE(heartbeat);
    EXPECT_EQ(heartbeat->autopilot, 3);
  }
}

// The latency of a set-point is measured from the capture time of the newest pose. Without a pose
// it is not measured.
TEST(WireQuadrotor, ReportsAgesFromTheNewestCapture) {
  const std::string port = port_of_this_test(1);
  WireQuadrotor vehicle(flier_at(port), {}, 1, 1, kStart);
  Driver driver(port);
  driver.send(wire::mavlink::SetPositionTargetLocalNed{});
  vehicle.exchange(kStart);
  EXPECT_EQ(counts_of(vehicle).count("wire.Q2.setpoint_max_us"), 0u);
  EXPECT_EQ(counts_of(vehicle).count("wire.Q2.pose_max_us"), 0u);
  // The pose is 24 h and the odometry 1 h older than kStart; kStart itself is in the past.
  constexpr std::int64_t kHourUs = 3'600'000'000;
  wire::mavlink::VisionPositionEstimate vision;
  vision.usec = static_cast<std::uint64_t>(to_utime(kStart) - 24 * kHourUs);
  driver.send(vision);
  vehicle.exchange(kStart);
  const std::int64_t vision_us = counts_of(vehicle).at("wire.Q2.pose_max_us");
  wire::mavlink::Odometry odometry;
  odometry.time_usec = static_cast<std::uint64_t>(to_utime(kStart) - kHourUs);
  driver.send(odometry);
  driver.send(wire::mavlink::SetPositionTargetLocalNed{});
  vehicle.exchange(kStart);
  const auto counts = counts_of(vehicle);
  EXPECT_EQ(counts.at("wire.Q2.pose_max_us"), vision_us) << "the longer of both";
  // The tolerance is a minute, the maximum duration of this test.
  const std::int64_t between_us = vision_us - counts.at("wire.Q2.setpoint_max_us");
  EXPECT_NEAR(static_cast<double>(between_us), 23.0 * static_cast<double>(kHourUs), 60e6);
  EXPECT_EQ(counts.at("wire.Q2.send_errors"), 0);
  EXPECT_EQ(counts.at("wire.Q2.bytes_skipped"), 0);
  driver.socket.write(std::vector<std::uint8_t>{1, 2, 3});
  vehicle.exchange(kStart);
  EXPECT_EQ(counts_of(vehicle).at("wire.Q2.bytes_skipped"), 3);
  EXPECT_EQ(counts_of(vehicle).at("wire.Q2.ignored"), vehicle.emulator().ignored());
}

TEST(WireQuadrotor, StartsAtAWholeStepAndNeverGoesBack) {
  const std::string port = port_of_this_test(2);
  WireQuadrotor vehicle(flier_at(port), {}, 1, 1, kStart);  // kStart is 3 ms after a whole step
  Driver driver(port);
  driver.send(wire::mavlink::Heartbeat{});
  int heartbeats = 0;
  const auto receive_frames = [&] {
    for (const wire::mavlink::Frame& frame : driver.receive_frames()) {
      heartbeats += wire::mavlink::unpack<wire::mavlink::Heartbeat>(frame) ? 1 : 0;
    }
  };
  vehicle.step(kStart, 0.0019);
  vehicle.exchange(kStart + Duration{1'900});
  receive_frames();
  EXPECT_EQ(heartbeats, 0) << "no whole step has passed";
  vehicle.step(kStart + Duration{1'900}, 0.0001);
  vehicle.exchange(kStart + Duration{2'000});
  receive_frames();
  EXPECT_EQ(heartbeats, 1);
  vehicle.step(kStart + Duration{997'000}, 0.005);
  vehicle.step(kStart, 0.005);
  vehicle.exchange(kStart + Duration{1'002'000});
  receive_frames();
  EXPECT_EQ(heartbeats, 2) << "one second after the start";
}

TEST(WireQuadrotor, ReportsWhyItCannotBeSimulated) {
  const auto why = [](const scenario::RobotSpec& robot) {
    try {
      const WireQuadrotor vehicle(robot, {}, 1, 1, kStart);
    } catch (const StartupError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  scenario::RobotSpec robot = flier_at(port_of_this_test(3));
  robot.autopilot->key_file = "key";
  EXPECT_EQ(why(robot), "robot Q2: the simulated autopilot cannot sign; remove `key_file`");
  robot.autopilot->url.clear();
  EXPECT_EQ(why(robot),
            "robot Q2 has device 'wire': it needs an `autopilot` or a `rover` with a `url`");
}

TEST(AirframeIn, RotatesTheWindAndHasDefaultGusts) {
  const AirframeParameters windy = airframe_in(scenario::WindSpec{2.0, -1.0, 0.7});
  EXPECT_EQ(windy.wind_mean_mps, Eigen::Vector3d(2.0, 1.0, 0.0));
  EXPECT_EQ(windy.wind_sigma_mps, 0.7);
  EXPECT_EQ(airframe_in(std::nullopt).wind_mean_mps, Eigen::Vector3d::Zero());
  EXPECT_EQ(airframe_in(std::nullopt).wind_sigma_mps, AirframeParameters{}.wind_sigma_mps);
}

// The limits are a tenth above those of the scenario, or those of a default rover if these are
// higher.
TEST(WireRover, LimitsExceedThoseOfTheScenarioByATenth) {
  struct Row {
    double speed_mps, brake_mps2, yaw_rate_radps;
    double fastest_mps, stop_s, turn_radps;
  };
  for (const Row& row :
       {Row{2.0, 4.0, 3.0, 2.2, 2.2 / 4.4, 3.3}, Row{0.5, 1.0, 1.0, 1.4, 0.7, 2.0}}) {
    const std::string port = port_of_this_test(0);
    scenario::RobotSpec robot = test::lab_scenario().robots[1];
    robot.rover.emplace();
    robot.rover->url = "udpout://127.0.0.1:" + port;
    robot.rover->number = 7;
    robot.start = {1.0, 2.0, 2.0};
    robot.limits.speed_max_mps = row.speed_mps;
    robot.limits.brake_mps2 = row.brake_mps2;
    robot.limits.yaw_rate_max_radps = row.yaw_rate_radps;
    WireRover rover(robot, 1, kStart);
    VehicleSocket driver("udp://127.0.0.1:" + port);
    wire::rover::Command command{7, 41, 0, 0, 9.0F, 9.0F, wire::rover::kDrive};
    Time now = kStart;
    const auto drive = [&](double seconds) {
      for (const Time end = now + from_seconds(seconds); now < end; now += Duration{5'000}) {
        ++command.sequence;
        driver.write(wire::rover::encode(command));
        rover.step(now, 0.005);
        rover.exchange(now + Duration{5'000});
        driver.read_each([](auto, Time) {});
      }
    };
    drive(3.0);
    const RoverState& state = rover.emulator().state();
    EXPECT_NEAR(state.speed_mps, row.fastest_mps, 1e-6);
    EXPECT_NEAR(state.yaw_rate_radps, row.turn_radps, 1e-6);
    const double yaw_rad = state.world_from_body.yaw_rad;
    EXPECT_LT((rover.velocity_world_mps() -
               row.fastest_mps * Eigen::Vector3d(std::cos(yaw_rad), std::sin(yaw_rad), 0.0))
                  .norm(),
              1e-6);
    command.speed_mps = 0.0F;
    drive(row.stop_s - 0.02);
    EXPECT_GT(rover.emulator().state().speed_mps, 0.0);
    drive(0.1);
    EXPECT_EQ(rover.emulator().state().speed_mps, 0.0);
    EXPECT_EQ(rover.radius_m(), robot.limits.radius_m);
    command.robot = 8;
    drive(0.01);
    const auto counts = counts_of(rover);
    EXPECT_EQ(counts.at("wire.Q2.refused"), 2);
    EXPECT_EQ(counts.at("wire.Q2.send_errors"), 0);
    rover.step(kStart, 0.005);  // long before the current time
    EXPECT_EQ(rover.emulator().state().speed_mps, 0.0);
  }
}

TEST(WireRover, ReportsItsRequirements) {
  scenario::RobotSpec robot = test::lab_scenario().robots[1];
  robot.rover.emplace();
  try {
    const WireRover rover(robot, 1, kStart);
    FAIL();
  } catch (const StartupError& error) {
    EXPECT_EQ(std::string(error.what()),
              "robot Q2 has device 'wire': it needs a `rover` with a `url`");
  }
}

// Without an address, the error names the section of the robot's kind.
TEST(MakeWireVehicle, CreatesAnEmulatorForEachKind) {
  scenario::Scenario scenario = test::lab_scenario();
  const auto why = [&] {
    try {
      make_wire_vehicle(scenario, 1, kStart);
    } catch (const StartupError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  scenario::RobotSpec& robot = scenario.robots[1];
  robot.autopilot.reset();
  robot.rover.reset();
  EXPECT_EQ(
      why(),
      "robot Q2 has device 'wire': it needs `autopilot` or `rover` or `crazyflie` with a `url`");
  for (const scenario::VehicleKind& kind : scenario::all_vehicle_kinds()) {
    robot.autopilot.reset();
    robot.rover.reset();
    robot.crazyflie.reset();
    if (kind.section == "autopilot") {
      robot.autopilot.emplace();
    } else if (kind.section == "rover") {
      robot.rover.emplace();
    } else if (kind.section == "crazyflie") {
      robot.crazyflie.emplace();
    }
    ASSERT_EQ(scenario::vehicle_kind(robot), &kind);
    EXPECT_NE(why().find("`" + std::string(kind.section) + "`"), std::string::npos) << why();
    EXPECT_EQ(why().find("has no emulator"), std::string::npos);
  }
}

// The port in use shows for which firmware the vehicle waits.
TEST(WireFirmware, WaitsForItsFirmwareWhenItStarts) {
  scenario::RobotSpec robot = test::lab_scenario().robots[1];
  robot.autopilot.emplace();
  robot.firmware.emplace();
  const int instance = 2400 + getpid() % 1000;
  const auto is_free = [&] {
    try {
      const WireFirmware second(robot, {}, instance, 2);
    } catch (const StartupError&) {
      return false;
    }
    return true;
  };
  for (const auto dialect :
       {models::AutopilotDialect::kPx4, models::AutopilotDialect::kArdupilot}) {
    robot.autopilot->dialect = dialect;
    robot.firmware->serial.clear();
    ASSERT_TRUE(is_free());
    WireFirmware vehicle(robot, {}, instance, 1);
    EXPECT_FALSE(is_free());
    robot.firmware->serial = "/nowhere/at/all";
    EXPECT_EQ(is_free(), dialect == models::AutopilotDialect::kPx4)
        << "a serial board needs no port";
    EXPECT_EQ(vehicle.name(), "Q2");
    EXPECT_EQ(vehicle.radius_m(), robot.limits.radius_m);
    vehicle.step(kStart, 0.005);
    vehicle.exchange(kStart + Duration{5'000});
    vehicle.step(kStart + Duration{5'000}, 0.005);
    const Eigen::Vector3d expected(robot.start.x_m, robot.start.y_m, 0.0);
    EXPECT_LT((vehicle.world_from_body().translation_m - expected).norm(), 1e-3);
    EXPECT_NEAR(flatten(vehicle.world_from_body()).yaw_rad, robot.start.yaw_rad, 1e-3);
    EXPECT_LT(vehicle.velocity_world_mps().norm(), 1e-2);
    const auto counts = vehicle.counters();
    ASSERT_EQ(counts.size(), 3u);
    EXPECT_EQ(counts[0].name, "wire.Q2.firmware_silences");
    EXPECT_EQ(counts[0].count, 0);
    EXPECT_EQ(counts[1].name, "wire.Q2.firmware_resumed");
    EXPECT_EQ(counts[2].name, "wire.Q2.firmware_dropped");
  }
}

}  // namespace
}  // namespace vantage::sim
