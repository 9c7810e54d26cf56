// The node with its socket: virtual time, real datagrams on the loopback, an in-process bus.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "bus/channels.hpp"
#include "bus/transport.hpp"
#include "core/check.hpp"
#include "drivers/rover/app/node.hpp"
#include "sim/rover/rover_endpoint.hpp"
#include "test/drivers/rover_bench.hpp"

namespace vantage::drivers {
namespace {

using models::OperatorAction;
using test::RoverBench;

std::string url_of_this_test() {
  return "udpout://127.0.0.1:" + std::to_string(20'000 + (getpid() * 4 + 3) % 20'000);
}

struct NodeBench {
  NodeBench() {
    lab.subscribe<models::VehicleStatus>(
        bus::quadrotor_channel("R1"),
        [this](const models::VehicleStatus& heard) { statuses.push_back(heard); });
  }
  void say(OperatorAction action) {
    models::OperatorCommand command;
    command.stamp.time = clock.now();
    command.action = action;
    lab.publish(bus::kCommand, command);
  }
  bool run_until(const std::function<bool()>& done, double seconds) {
    const Time end = clock.now() + from_seconds(seconds);
    for (; clock.now() < end && !done(); ++steps) {
      clock.set(clock.now() + Duration{5'000});
      rover.run_to(clock.now());
      if (steps % 2 == 0) {
        models::MocapFrame frame;
        frame.stamp.time = frame.arrival = clock.now();
        frame.frame_number = steps;
        models::MocapBody body;
        body.name = "R1";
        body.world_from_body = lift(rover.emulator().state().world_from_body, 0.2);
        body.world_from_body.translation_m.x() += 1e-4 * std::sin(static_cast<double>(steps));
        frame.bodies.push_back(body);
        lab.publish(bus::kVicon, frame);
      }
      if (steps % 40 == 0) {
        say(OperatorAction::kHeartbeat);
      }
      node_bus.handle(std::chrono::microseconds(0));
      if (clock.now() >= node.next_tick()) {
        node.tick(clock.now());
      }
      lab.handle(std::chrono::microseconds(0));
    }
    return done();
  }
  void run(double seconds) {
    run_until([] { return false; }, seconds);
  }

  std::string url = url_of_this_test();
  bus::InProcessHub hub;
  bus::VirtualClock clock{RoverBench::kStart};
  std::unique_ptr<bus::Transport> node_side = hub.connect();
  std::unique_ptr<bus::Transport> lab_side = hub.connect();
  bus::Bus node_bus{*node_side, 11};
  bus::Bus lab{*lab_side, 22};
  models::Scenario scenario = RoverBench::scenario_for();
  RoverNode node{node_bus, clock, scenario, "R1", open_port(url)};
  sim::RoverEndpoint rover{RoverBench::rover_spec(), url, RoverBench::kStart};
  std::vector<models::VehicleStatus> statuses;
  std::int64_t steps = 0;
};

TEST(RoverNode, DrivesAPlanFromTheBusAndStopsOnCommand) {
  NodeBench bench;
  ASSERT_TRUE(bench.run_until(
      [&] { return !bench.statuses.empty() && bench.statuses.back().reasons.empty(); }, 3.0));
  bench.say(OperatorAction::kArm);
  bench.run(0.1);
  bench.say(OperatorAction::kFollow);
  bench.run(0.1);
  models::RobotPlan plan;
  plan.stamp.time = bench.clock.now() + from_seconds(0.2);
  plan.robot = "R1";
  plan.round = 5;
  plan.trajectory = {plan.stamp.time, {1.0, 1.0, kPi / 2}, 0.2, RoverBench::straight(0.5, 9.0)};
  bench.lab.publish(bus::plan_channel("R1"), plan);
  bench.run(2.2);
  EXPECT_EQ(bench.statuses.back().state, models::FlightState::kFollow);
  EXPECT_EQ(bench.statuses.back().plan_round, 5);
  EXPECT_GT(bench.statuses.back().battery_share, 0.8);
  EXPECT_NEAR(bench.rover.emulator().state().world_from_body.y_m, 2.0, 0.1);
  bench.say(OperatorAction::kEmergencyStop);
  bench.run(0.4);
  EXPECT_EQ(bench.rover.emulator().state().speed_mps, 0.0);
  EXPECT_TRUE(bench.rover.emulator().is_stopped());
  EXPECT_EQ(bench.statuses.back().state, models::FlightState::kKilled);
  EXPECT_GT(static_cast<double>(bench.statuses.size()),
            9.9 * to_seconds(bench.clock.now() - RoverBench::kStart));
  for (const models::NamedCount& counter : bench.node.counters()) {
    EXPECT_EQ(counter.name == "mocap.clock_set" ? 0 : counter.count, 0) << counter.name;
  }
}

TEST(RoverNode, RefusesARobotThatIsNoRover) {
  bus::InProcessHub hub;
  const auto side = hub.connect();
  bus::Bus bus(*side, 1);
  const bus::VirtualClock clock(RoverBench::kStart);
  models::Scenario scenario = RoverBench::scenario_for();
  scenario.robots[0].rover.reset();
  EXPECT_THROW(RoverNode(bus, clock, scenario, "R1", open_port(url_of_this_test())), UsageError);
}

}  // namespace
}  // namespace vantage::drivers
