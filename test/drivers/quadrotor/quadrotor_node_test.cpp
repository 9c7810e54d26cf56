#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "bus/convert/channels.hpp"
#include "bus/transport/transport.hpp"
#include "core/check.hpp"
#include "drivers/quadrotor/app/node.hpp"
#include "sim/autopilot/endpoint.hpp"
#include "test/drivers/quadrotor/flight_bench.hpp"
#include "test/drivers/vehicle/vehicle_node_bench.hpp"
#include "test/support/udp_port.hpp"

namespace vantage::drivers {
namespace {

using models::AutopilotDialect;
using models::OperatorAction;
using test::FlightBench;
using test::port_of_this_test;

struct NodeBench : test::VehicleNodeBench<QuadrotorNode, sim::AutopilotEndpoint> {
  NodeBench(AutopilotDialect dialect, const std::string& url)
      : VehicleNodeBench(FlightBench::scenario_for(dialect), FlightBench::vehicle_for(dialect), url,
                         FlightBench::kStart, [](const sim::AutopilotEndpoint& quadrotor) {
                           return quadrotor.emulator().world_from_body();
                         }) {}
  bool is_armed() const { return vehicle.emulator().controller().is_armed(); }
  double height_m() const { return vehicle.emulator().world_from_body().translation_m.z(); }
};

void fly(NodeBench& bench) {
  ASSERT_TRUE(bench.run_until(
      [&] { return !bench.statuses.empty() && bench.statuses.back().reasons.empty(); }, 20.0));
  bench.send_command(OperatorAction::kArm);
  ASSERT_TRUE(bench.run_until([&] { return bench.is_armed(); }, 40.0));
  bench.run(1.5);
  bench.send_command(OperatorAction::kTakeOff);
  ASSERT_TRUE(bench.run_until([&] { return bench.height_m() > 0.9; }, 15.0));
  EXPECT_EQ(bench.statuses.back().state, models::FlightState::kHold);
  EXPECT_GT(bench.statuses.back().battery_share, 0.9);
  bench.send_command(OperatorAction::kLand);
  ASSERT_TRUE(bench.run_until([&] { return !bench.is_armed(); }, 30.0));
}

TEST(QuadrotorNode, FliesAVehicleThatSendsFirst) {
  NodeBench bench(AutopilotDialect::kPx4, "udp://127.0.0.1:" + port_of_this_test(0));
  fly(bench);
  // The node publishes at least ten statuses per second (1 % tolerance).
  EXPECT_GT(static_cast<double>(bench.statuses.size()),
            9.9 * to_seconds(bench.clock.now() - FlightBench::kStart));
}

TEST(QuadrotorNode, FliesAVehicleThatWaitsForItsDriver) {
  NodeBench bench(AutopilotDialect::kArdupilot, "udpout://127.0.0.1:" + port_of_this_test(1));
  fly(bench);
}

// Before the vehicle starts, another sender begins to send one byte every half second to the
// vehicle's port.
TEST(QuadrotorNode, FliesAVehicleDespiteAnotherSenderToItsPort) {
  const std::string port = port_of_this_test(0);
  const auto stranger = open_port("udpout://127.0.0.1:" + port);
  NodeBench bench(AutopilotDialect::kPx4, "udp://127.0.0.1:" + port);
  int steps = 0;
  bench.each_step = [&] {
    if (steps++ % 100 == 0) {
      stranger->write(std::vector<std::uint8_t>{0}, bench.clock.now());
    }
  };
  stranger->write(std::vector<std::uint8_t>{0}, bench.clock.now());
  fly(bench);
}

// Uses the failure text of run_node(), which the status shows to the operator.
TEST(QuadrotorNode, ReportsThatItsProcessWaitsForAProcessor) {
  NodeBench bench(AutopilotDialect::kPx4, "udp://127.0.0.1:" + port_of_this_test(3));
  const auto says_busy = [&] {
    const auto& reasons = bench.statuses.back().reasons;
    return std::find(reasons.begin(), reasons.end(), "host busy") != reasons.end();
  };
  bench.run(0.5);
  ASSERT_FALSE(bench.statuses.empty());
  EXPECT_FALSE(says_busy());
  bench.node.on_processor_wait(0.16);
  bench.run(0.2);
  EXPECT_TRUE(says_busy());
  bench.node.on_processor_wait(0.15);
  bench.run(0.2);
  EXPECT_FALSE(says_busy());
}

/// Arms and takes off; returns false if that fails.
bool hovers(NodeBench& bench) {
  if (!bench.run_until(
          [&] { return !bench.statuses.empty() && bench.statuses.back().reasons.empty(); }, 20.0)) {
    return false;
  }
  bench.send_command(OperatorAction::kArm);
  if (!bench.run_until([&] { return bench.is_armed(); }, 40.0)) {
    return false;
  }
  bench.run(1.5);
  bench.send_command(OperatorAction::kTakeOff);
  return bench.run_until([&] { return bench.height_m() > 0.9; }, 15.0);
}

constexpr AutopilotDialect kDialects[] = {AutopilotDialect::kPx4, AutopilotDialect::kArdupilot};

TEST(QuadrotorNode, LandsBeforeItEnds) {
  for (const AutopilotDialect dialect : kDialects) {
    NodeBench bench(dialect, "udpout://127.0.0.1:" + port_of_this_test(0));
    ASSERT_TRUE(hovers(bench));
    EXPECT_EQ(bench.node.in_flight(bench.clock.now()), InFlight::kYes);
    bench.node.on_stop_request(1, bench.clock.now());
    EXPECT_TRUE(bench.run_to_the_end(30.0));
    EXPECT_FALSE(bench.is_armed());
    EXPECT_LT(bench.height_m(), 0.1);
    EXPECT_EQ(bench.statuses.back().state, models::FlightState::kIdle);
    EXPECT_EQ(bench.node.end_fault(), "");
    EXPECT_EQ(bench.node.in_flight(bench.clock.now()), InFlight::kNo);
  }
}

TEST(QuadrotorNode, LeavesTheLandingToTheAutopilotAtTheSecondEndRequest) {
  for (const AutopilotDialect dialect : kDialects) {
    NodeBench bench(dialect, "udpout://127.0.0.1:" + port_of_this_test(0));
    ASSERT_TRUE(hovers(bench));
    bench.node.on_stop_request(1, bench.clock.now());
    bench.run(0.5);
    bench.node.on_stop_request(2, bench.clock.now());
    EXPECT_TRUE(bench.run_to_the_end(2.5));
    EXPECT_EQ(bench.node.end_fault(), "");
    EXPECT_TRUE(bench.is_armed()) << "the vehicle is never dropped";
    // The driver has ended, so the autopilot lands the vehicle by itself.
    EXPECT_TRUE(bench.vehicle.emulator().controller().is_armed());
    for (int i = 0; i < 6'000 && bench.is_armed(); ++i) {
      bench.clock.set(bench.clock.now() + Duration{5'000});
      bench.vehicle.run_to(bench.clock.now());
    }
    EXPECT_FALSE(bench.is_armed());
  }
}

TEST(QuadrotorNode, DisarmsAndEndsImmediatelyOnTheGround) {
  NodeBench bench(AutopilotDialect::kPx4, "udpout://127.0.0.1:" + port_of_this_test(0));
  ASSERT_TRUE(bench.run_until(
      [&] { return !bench.statuses.empty() && bench.statuses.back().reasons.empty(); }, 20.0));
  EXPECT_EQ(bench.node.in_flight(bench.clock.now()), InFlight::kNo);
  bench.send_command(OperatorAction::kArm);
  ASSERT_TRUE(bench.run_until([&] { return bench.is_armed(); }, 40.0));
  bench.node.on_stop_request(1, bench.clock.now());  // before a heartbeat reports it armed
  EXPECT_FALSE(bench.node.may_end(bench.clock.now()));
  EXPECT_TRUE(bench.run_to_the_end(5.0));
  EXPECT_FALSE(bench.is_armed());
}

TEST(QuadrotorNode, CountsFrameLatency) {
  NodeBench bench(AutopilotDialect::kPx4, "udp://127.0.0.1:" + port_of_this_test(3));
  bench.mocap_clock = -Duration{2'000};
  bench.run(1.0);
  const auto counted = [&](const std::string& name) {
    for (const models::NamedCount& each : bench.node.counters()) {
      if (each.name == "latency." + name) {
        return each.count;
      }
    }
    return std::int64_t{-1};
  };
  for (const std::string hop : {"frame_heard", "frame_setpoint"}) {
    EXPECT_EQ(counted(hop + "_p50_us"), 2'000) << hop;
    EXPECT_EQ(counted(hop + "_max_us"), 2'000) << hop;
  }
  models::MocapFrame dated = bench.see();
  for (const Time date : {Time::min(), Time::max(), Time{}}) {
    dated.arrival = date;
    bench.publish_forged(bus::kVicon, dated);
  }
  bench.run(0.1);
  EXPECT_EQ(counted("frame_setpoint_max_us"), 2'000) << "longer latencies are not plausible";
  EXPECT_EQ(counted("heard_setpoint_max_us"), 0)
      << "virtual time does not advance during an answer";
}

TEST(QuadrotorNode, RefusesARobotThatHasNoAutopilot) {
  bus::InProcessHub hub;
  const auto side = hub.connect();
  bus::Bus bus(*side, 1);
  const bus::VirtualClock clock(FlightBench::kStart);
  scenario::Scenario scenario = FlightBench::scenario_for(AutopilotDialect::kPx4);
  scenario.robots[0].autopilot.reset();
  const std::string url = "udpout://127.0.0.1:" + port_of_this_test(2);
  EXPECT_THROW(QuadrotorNode(bus, clock, scenario, "Q1", open_port(url)), UsageError);
  EXPECT_THROW(QuadrotorNode(bus, clock, scenario, "Q9", open_port(url)), UsageError);
}

TEST(LoadKey, RequiresExactlyThirtyTwoBytes) {
  const auto file =
      std::filesystem::temp_directory_path() / ("vantage_key_" + std::to_string(getpid()));
  using std::filesystem::perms;
  std::ofstream(file) << std::string(32, 'k');
  for (const perms open_to : {perms::group_read, perms::group_write, perms::others_read}) {
    std::filesystem::permissions(file, perms::owner_read | perms::owner_write | open_to);
    EXPECT_THROW(static_cast<void>(load_key(file.string())), StartupError)
        << "other users may access the file";
  }
  std::filesystem::permissions(file, perms::owner_read | perms::owner_write);
  const auto key = load_key(file.string());
  ASSERT_TRUE(key.has_value());
  EXPECT_EQ((*key)[31], 'k');
  if (geteuid() == 0) {
    ASSERT_EQ(chown(file.c_str(), 12345, getegid()), 0);
    EXPECT_THROW(static_cast<void>(load_key(file.string())), StartupError)
        << "the file belongs to another user";
    ASSERT_EQ(chown(file.c_str(), 0, getegid()), 0);
  }
  std::ofstream(file) << std::string(31, 'k');
  EXPECT_THROW(static_cast<void>(load_key(file.string())), StartupError);
  std::filesystem::remove(file);
  EXPECT_THROW(static_cast<void>(load_key(file.string())), StartupError);
  EXPECT_FALSE(load_key("").has_value());
}

}  // namespace
}  // namespace vantage::drivers
