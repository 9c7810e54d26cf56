#include "sim/app/wire_rover.hpp"

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "sim/vehicle_socket.hpp"
#include "test/sim/lab_scenario.hpp"
#include "test/support/udp_port.hpp"
#include "wire/rover/packet.hpp"

namespace vantage::sim {
namespace {

using test::port_of_this_test;

constexpr Time kStart = from_utime(1'700'000'000'003'000);

scenario::RobotSpec robot_at(const std::string& url) {
  scenario::RobotSpec robot = test::lab_scenario().robots[1];
  robot.device = scenario::DeviceSource::kWire;
  robot.height_m = 0.2;
  robot.start = {-1.0, 0.5, 1.2};
  robot.rover.emplace();
  robot.rover->url = url;
  robot.rover->number = 7;
  return robot;
}

// Performs a step of the world and exchanges the messages at its end.
Time step(WireRover& rover, Time now) {
  rover.step(now, 0.005);
  rover.exchange(now + Duration{5'000});
  return now + Duration{5'000};
}

TEST(WireRover, RestsAtItsStartAtMarkerHeight) {
  const scenario::RobotSpec robot = robot_at("udpout://127.0.0.1:" + port_of_this_test(0));
  WireRover rover(robot, 1, kStart);
  Time now = kStart;
  for (int i = 0; i < 200; ++i) {
    now = step(rover, now);
  }
  EXPECT_EQ(rover.world_from_body().translation_m, Eigen::Vector3d(-1.0, 0.5, 0.2));
  EXPECT_NEAR(flatten(rover.world_from_body()).yaw_rad, 1.2, 1e-12);
  EXPECT_EQ(rover.velocity_world_mps(), Eigen::Vector3d::Zero());
  EXPECT_EQ(rover.name(), robot.name);
}

TEST(WireRover, MovesAsItsWheelsTurn) {
  const std::string port = port_of_this_test(1);
  // Both ends use the same socket class. The driver waits, so the rover sends first.
  WireRover rover(robot_at("udpout://127.0.0.1:" + port), 1, kStart);
  VehicleSocket driver("udp://127.0.0.1:" + port);
  wire::rover::Command command;
  command.robot = 7;
  command.session = 41;
  command.speed_mps = 0.5F;
  command.flags = wire::rover::kDrive;
  Time now = kStart;
  for (int i = 0; i < 400; ++i) {  // 2 s in total
    if (i % 4 == 0) {
      ++command.sequence;
      driver.write(wire::rover::encode(command));
    }
    const Pose3 before = rover.world_from_body();
    now = step(rover, now);
    const Eigen::Vector3d moved_m = rover.world_from_body().translation_m - before.translation_m;
    // Tyres slip, so the true speed is a little below that of the wheels.
    EXPECT_LE((moved_m - 0.005 * rover.velocity_world_mps()).norm(), 0.005 * 0.05);
  }
  EXPECT_NEAR(rover.velocity_world_mps().norm(), 0.5, 1e-6);
  EXPECT_EQ(rover.world_from_body().translation_m.z(), 0.2);
  const Eigen::Vector3d offset_m =
      rover.world_from_body().translation_m - Eigen::Vector3d(-1, 0.5, 0.2);
  // The ramp costs 0.25 s of motion and the delay 0.035 s; slip reduces the distance by 3 %.
  EXPECT_NEAR(offset_m.norm(), 0.5 * (2.0 - 0.25 - 0.035) * 0.97, 0.03);
  for (int i = 0; i < 200; ++i) {  // the driver no longer sends
    now = step(rover, now);
  }
  EXPECT_EQ(rover.velocity_world_mps().norm(), 0.0);
}

TEST(WireRover, RefusesUnsupportedSpecs) {
  scenario::RobotSpec robot = test::lab_scenario().robots[0];
  EXPECT_THROW(WireRover(robot, 1, kStart), StartupError);  // the robot has no rover
  for (const char* url :
       {"", "serial:/dev/ttyUSB0:921600", "udpout://127.0.0.1", "udpout://:0", "udp://:14550x"}) {
    EXPECT_THROW(WireRover(robot_at(url), 1, kStart), StartupError) << url;
  }
}

}  // namespace
}  // namespace vantage::sim
