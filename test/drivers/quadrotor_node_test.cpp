// The node with its sockets: virtual time, real datagrams on the loopback, an in-process bus.

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "bus/channels.hpp"
#include "bus/transport.hpp"
#include "core/check.hpp"
#include "drivers/quadrotor/app/node.hpp"
#include "sim/autopilot/endpoint.hpp"
#include "test/drivers/flight_bench.hpp"

namespace vantage::drivers {
namespace {

using models::AutopilotDialect;
using models::OperatorAction;
using test::FlightBench;

struct NodeBench {
  explicit NodeBench(AutopilotDialect dialect, const std::string& url)
      : scenario(FlightBench::scenario_for(dialect)),
        node(node_bus, clock, scenario, "Q1", open_port(url)),
        vehicle(FlightBench::vehicle_for(dialect), url, FlightBench::kStart) {
    lab.subscribe<models::VehicleStatus>(
        bus::quadrotor_channel("Q1"),
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
      vehicle.run_to(clock.now());
      if (steps % 2 == 0) {
        models::MocapFrame frame;
        frame.stamp.time = frame.arrival = clock.now();
        frame.frame_number = steps;
        models::MocapBody body;
        body.name = "Q1";
        body.world_from_body = vehicle.emulator().world_from_body();
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
  bool is_armed() const { return vehicle.emulator().controller().is_armed(); }
  double height_m() const { return vehicle.emulator().world_from_body().translation_m.z(); }

  bus::InProcessHub hub;
  bus::VirtualClock clock{FlightBench::kStart};
  std::unique_ptr<bus::Transport> node_side = hub.connect();
  std::unique_ptr<bus::Transport> lab_side = hub.connect();
  bus::Bus node_bus{*node_side, 11};
  bus::Bus lab{*lab_side, 22};
  models::Scenario scenario;
  QuadrotorNode node;
  sim::AutopilotEndpoint vehicle;
  std::vector<models::VehicleStatus> statuses;
  std::int64_t steps = 0;
};

void fly(NodeBench& bench) {
  ASSERT_TRUE(bench.run_until(
      [&] { return !bench.statuses.empty() && bench.statuses.back().reasons.empty(); }, 20.0));
  bench.say(OperatorAction::kArm);
  ASSERT_TRUE(bench.run_until([&] { return bench.is_armed(); }, 40.0));
  bench.run_until([] { return false; }, 1.5);
  bench.say(OperatorAction::kTakeOff);
  ASSERT_TRUE(bench.run_until([&] { return bench.height_m() > 0.9; }, 15.0));
  EXPECT_EQ(bench.statuses.back().state, models::FlightState::kHold);
  EXPECT_GT(bench.statuses.back().battery_share, 0.9);
  bench.say(OperatorAction::kLand);
  ASSERT_TRUE(bench.run_until([&] { return !bench.is_armed(); }, 30.0));
}

std::string port_of_this_test(int offset) {
  return std::to_string(20'000 + (getpid() * 4 + offset) % 20'000);
}

TEST(QuadrotorNode, FliesAVehicleThatSpeaksToItsPort) {
  NodeBench bench(AutopilotDialect::kPx4, "udp://127.0.0.1:" + port_of_this_test(0));
  fly(bench);
  // At least ten words a second.
  EXPECT_GT(static_cast<double>(bench.statuses.size()),
            9.9 * to_seconds(bench.clock.now() - FlightBench::kStart));
}

TEST(QuadrotorNode, FliesAVehicleThatWaitsForIt) {
  NodeBench bench(AutopilotDialect::kArdupilot, "udpout://127.0.0.1:" + port_of_this_test(1));
  fly(bench);
}

TEST(QuadrotorNode, RefusesARobotThatHasNoAutopilot) {
  bus::InProcessHub hub;
  const auto side = hub.connect();
  bus::Bus bus(*side, 1);
  const bus::VirtualClock clock(FlightBench::kStart);
  models::Scenario scenario = FlightBench::scenario_for(AutopilotDialect::kPx4);
  scenario.robots[0].autopilot.reset();
  const std::string url = "udpout://127.0.0.1:" + port_of_this_test(2);
  EXPECT_THROW(QuadrotorNode(bus, clock, scenario, "Q1", open_port(url)), UsageError);
  EXPECT_THROW(QuadrotorNode(bus, clock, scenario, "Q9", open_port(url)), UsageError);
}

TEST(LoadKey, TakesThirtyTwoBytesAndNothingElse) {
  const auto file =
      std::filesystem::temp_directory_path() / ("vantage_key_" + std::to_string(getpid()));
  std::ofstream(file) << std::string(32, 'k');
  const auto key = load_key(file.string());
  ASSERT_TRUE(key.has_value());
  EXPECT_EQ((*key)[31], 'k');
  std::ofstream(file) << std::string(31, 'k');
  EXPECT_THROW(static_cast<void>(load_key(file.string())), StartupError);
  std::filesystem::remove(file);
  EXPECT_THROW(static_cast<void>(load_key(file.string())), StartupError);
  EXPECT_FALSE(load_key("").has_value());
}

}  // namespace
}  // namespace vantage::drivers
