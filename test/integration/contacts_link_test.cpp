#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/channels.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "drivers/contacts/app/node.hpp"
#include "test/integration/network_support.hpp"
#include "test/sim/lab_scenario.hpp"

// Collisions of real vehicles that mocap sees are judged and published on the network.

namespace vantage {
namespace {

TEST(ContactsLink, PublishesCollisionOfRealVehicles) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.mocap.device = scenario::DeviceSource::kReal;
  for (scenario::RobotSpec& robot : scenario.robots) {
    robot.device = scenario::DeviceSource::kReal;
  }
  const auto judge_link = bus::open_transport(test::kUrl);
  const auto lab_link = bus::open_transport(test::kUrl);
  bus::VirtualClock clock(from_utime(1'700'000'000'000'000));
  bus::Bus judge_bus(*judge_link, 11);
  bus::Bus lab_bus(*lab_link, 22);
  judge_bus.use_clock(clock);
  const drivers::ContactsNode node(judge_bus, clock, scenario);
  std::vector<models::CollisionReport> received;
  lab_bus.subscribe<models::CollisionReport>(
      bus::kCollision,
      [&](const models::CollisionReport& contact) { received.push_back(contact); });

  const auto start = clock.now();
  models::VehicleStatus status;
  status.stamp.time = start;
  status.robot = "Q1";
  status.state = models::FlightState::kFollow;
  lab_bus.publish(bus::vehicle_channel("Q1"), status);
  judge_bus.handle(test::kPatience);
  // Q2 is stationary. Q1 approaches at 1 m/s and touches it after 0.5 m.
  constexpr int kFrames = 60;
  for (int k = 0; k < kFrames; ++k) {
    models::MocapFrame frame;
    frame.stamp.time = start + k * std::chrono::milliseconds(10);
    frame.arrival = frame.stamp.time;
    clock.set(frame.arrival);
    frame.bodies = {{"Q1", lift({1.0 + 0.01 * k, 4.0, 0.0}, 1.0), false},
                    {"Q2", lift({2.0, 4.0, 0.0}, 1.0), false}};
    lab_bus.publish(bus::kVicon, frame);
    judge_bus.handle(test::kPatience);
  }
  while (received.size() < 2 && lab_bus.handle(test::kPatience) > 0) {
  }
  ASSERT_EQ(received.size(), 2U);
  EXPECT_EQ(received[0].kind, models::CollisionKind::kNearMiss);
  EXPECT_EQ(received[1].kind, models::CollisionKind::kCollision);
  EXPECT_EQ(received[1].body_a + " " + received[1].body_b, "Q1 Q2");
  EXPECT_GE(received[1].stamp.time - start, std::chrono::milliseconds(490));
}

}  // namespace
}  // namespace vantage
