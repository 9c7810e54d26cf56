#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "bus/convert/channels.hpp"
#include "bus/transport/transport.hpp"
#include "core/check.hpp"
#include "drivers/rover/app/node.hpp"
#include "sim/rover/rover_endpoint.hpp"
#include "test/drivers/rover/rover_bench.hpp"
#include "test/drivers/vehicle/vehicle_node_bench.hpp"
#include "test/support/udp_port.hpp"

namespace vantage::drivers {
namespace {

using models::OperatorAction;
using test::RoverBench;

std::string url_of_this_test() { return "udpout://127.0.0.1:" + test::port_of_this_test(3); }

struct NodeBench : test::VehicleNodeBench<RoverNode, sim::RoverEndpoint> {
  NodeBench()
      : VehicleNodeBench(RoverBench::scenario_for(), RoverBench::rover_spec(), url_of_this_test(),
                         RoverBench::kStart, [](const sim::RoverEndpoint& rover) {
                           return lift(rover.emulator().state().world_from_body, 0.2);
                         }) {}

  /// Arms, commands `follow` and publishes a straight plan of round 5; returns false if the rover
  /// is not ready.
  bool start_plan() {
    if (!run_until([&] { return !statuses.empty() && statuses.back().reasons.empty(); }, 3.0)) {
      return false;
    }
    send_command(OperatorAction::kArm);
    run(0.1);
    send_command(OperatorAction::kFollow);
    run(0.1);
    models::RobotPlan plan;
    plan.stamp.time = clock.now() + from_seconds(0.2);
    plan.robot = "R1";
    plan.round = 5;
    plan.trajectory = {plan.stamp.time, {1.0, 1.0, kPi / 2}, 0.2, RoverBench::straight(0.5, 9.0)};
    lab.publish(bus::plan_channel("R1"), plan);
    return true;
  }
};

TEST(RoverNode, DrivesAPlanFromTheBusAndStopsOnCommand) {
  NodeBench bench;
  ASSERT_TRUE(bench.start_plan());
  bench.run(2.2);
  EXPECT_EQ(bench.statuses.back().state, models::FlightState::kFollow);
  EXPECT_EQ(bench.statuses.back().plan_round, 5);
  EXPECT_GT(bench.statuses.back().battery_share, 0.8);
  EXPECT_NEAR(bench.vehicle.emulator().state().world_from_body.y_m, 2.0, 0.1);
  bench.send_command(OperatorAction::kEmergencyStop);
  bench.run(0.4);
  EXPECT_EQ(bench.vehicle.emulator().state().speed_mps, 0.0);
  EXPECT_TRUE(bench.vehicle.emulator().is_stopped());
  EXPECT_EQ(bench.statuses.back().state, models::FlightState::kKilled);
  EXPECT_GT(static_cast<double>(bench.statuses.size()),
            9.9 * to_seconds(bench.clock.now() - RoverBench::kStart));
  for (const models::NamedCount& counter : bench.node.counters()) {
    EXPECT_EQ(counter.name == "mocap.clock_set" ? 0 : counter.count, 0) << counter.name;
  }
}

// The rover holds while its process waits for a processor. After more than 3 s, the operator must
// command `follow` again.
TEST(RoverNode, HoldsWhileItsProcessWaitsForAProcessor) {
  NodeBench bench;
  ASSERT_TRUE(bench.start_plan());
  bench.run(1.0);
  EXPECT_EQ(bench.statuses.back().state, models::FlightState::kFollow);
  bench.node.on_processor_wait(0.31);
  bench.run(0.2);
  EXPECT_EQ(bench.statuses.back().state, models::FlightState::kHold);
  EXPECT_NE(std::find(bench.statuses.back().reasons.begin(), bench.statuses.back().reasons.end(),
                      "waits for processor"),
            bench.statuses.back().reasons.end());
  bench.run(3.0);
  bench.node.on_processor_wait(0.0);
  bench.run(1.0);
  EXPECT_EQ(bench.statuses.back().state, models::FlightState::kHold)
      << "after more than 3 s the operator must command follow";
}

TEST(RoverNode, StopsBeforeItEnds) {
  NodeBench bench;
  ASSERT_TRUE(bench.start_plan());
  bench.run(1.5);
  EXPECT_EQ(bench.node.in_flight(bench.clock.now()), InFlight::kYes);
  bench.node.on_stop_request(1, bench.clock.now());
  EXPECT_FALSE(bench.node.may_end(bench.clock.now()));
  EXPECT_TRUE(bench.run_to_the_end(2.0));
  EXPECT_NEAR(bench.vehicle.emulator().state().speed_mps, 0.0, 0.02);
  EXPECT_EQ(bench.node.end_fault(), "");
}

// During the drive an old log is replayed, which contains mocap frames and a stop.
TEST(RoverNode, IgnoresAnOldLogAndASecondMocap) {
  NodeBench bench;
  ASSERT_TRUE(bench.start_plan());
  bench.each_step = [&, sequence = std::int64_t{0}]() mutable {
    if (bench.steps % 2 == 1) {
      models::MocapFrame frame = bench.see();
      frame.stamp.run_id = bench.steps % 4 == 1 ? 5 : 6;
      frame.stamp.time -= bench.steps % 4 == 1 ? std::chrono::hours(24) : std::chrono::hours(0);
      frame.stamp.sequence = sequence++;
      frame.bodies[0].world_from_body.translation_m = {-1.0, -1.0, 0.2};
      bench.publish_forged(bus::kVicon, frame);
      models::OperatorCommand stop;
      stop.stamp = {bench.clock.now() - std::chrono::hours(24), 5, sequence};
      stop.action = OperatorAction::kEmergencyStop;
      bench.publish_forged(bus::kCommand, stop);
    }
  };
  bench.run(2.2);
  EXPECT_EQ(bench.statuses.back().state, models::FlightState::kFollow);
  EXPECT_NEAR(bench.vehicle.emulator().state().world_from_body.y_m, 2.0, 0.1);
}

TEST(RoverNode, RefusesRobotsThatAreNotRovers) {
  bus::InProcessHub hub;
  const auto side = hub.connect();
  bus::Bus bus(*side, 1);
  const bus::VirtualClock clock(RoverBench::kStart);
  scenario::Scenario scenario = RoverBench::scenario_for();
  scenario.robots[0].rover.reset();
  EXPECT_THROW(RoverNode(bus, clock, scenario, "R1", open_port(url_of_this_test())), UsageError);
}

}  // namespace
}  // namespace vantage::drivers
