// Tests which messages a flying vehicle accepts through its node and a real bus: forged sequence
// numbers, old logs, a second mocap, changed clocks.

#include "test/drivers/vehicle/vehicle_trust.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace vantage::drivers {
namespace {

using models::FlightState;
using models::OperatorAction;
using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::kFarAhead;
using test::kLabRun;
using test::kOtherClock;
using test::kOtherRun;
using test::kSecondSource;
using test::VehicleTrust;

// ---- Channel COMMAND ----

TEST_F(VehicleTrust, AcceptsAStopAfterForgedSequenceNumbers) {
  take_off();
  bench.publish_forged(bus::kCommand, command(OperatorAction::kHeartbeat, kLabRun, kFarAhead, {}));
  bench.publish_forged(bus::kCommand,
                       command(OperatorAction::kHeartbeat, kLabRun,
                               std::numeric_limits<std::int64_t>::max(), Duration{1}));
  bench.run(5.0);
  EXPECT_TRUE(only_hovered()) << "the genuine heartbeat is still accepted";
  bench.send_command(OperatorAction::kEmergencyStop);
  bench.run(0.05);
  EXPECT_EQ(bench.state(), FlightState::kKilled);
}

TEST_F(VehicleTrust, AcceptsAStopWithAnOldSequenceNumber) {
  take_off();
  bench.publish_forged(bus::kCommand, command(OperatorAction::kEmergencyStop, kLabRun, 3, {}));
  bench.run(0.05);
  EXPECT_EQ(bench.state(), FlightState::kKilled);
}

TEST_F(VehicleTrust, IgnoresAStaleStop) {
  take_off();
  for (const OperatorAction action :
       {OperatorAction::kHold, OperatorAction::kLand, OperatorAction::kEmergencyStop}) {
    bench.publish_forged(bus::kCommand, command(action, kOtherRun, 0, hours(24)));
    bench.run(0.5);
    EXPECT_EQ(bench.state(), FlightState::kHold);
  }
  EXPECT_TRUE(only_hovered());
  EXPECT_EQ(bench.count("command.refused"), 3);
}

TEST_F(VehicleTrust, IgnoresStopsOfAnOldLog) {
  take_off();
  std::int64_t sequence = 500;
  bench.each_step = [&] {
    if (bench.steps % 40 == 0) {
      bench.publish_forged(bus::kCommand,
                           command(OperatorAction::kHeartbeat, kOtherRun, sequence++, hours(24)));
    }
    if (bench.steps % 100 == 99) {
      bench.publish_forged(
          bus::kCommand, command(OperatorAction::kEmergencyStop, kOtherRun, sequence++, hours(24)));
      bench.publish_forged(bus::kCommand,
                           command(OperatorAction::kLand, kOtherRun, sequence++, hours(24)));
    }
  };
  bench.run(5.0);
  EXPECT_TRUE(only_hovered());
}

TEST_F(VehicleTrust, IgnoresReplayedCommandsOfTheOperator) {
  take_off();
  for (const OperatorAction action : {OperatorAction::kLand, OperatorAction::kEmergencyStop}) {
    bench.publish_forged(bus::kCommand, command(action, kLabRun, 5, std::chrono::seconds(30)));
    bench.run(0.2);
  }
  EXPECT_TRUE(only_hovered());
}

TEST_F(VehicleTrust, KeepsTheOperatorThroughAClockChange) {
  take_off();
  for (const Duration set :
       {Duration(-std::chrono::seconds(3)), Duration(-hours(1)), Duration(hours(1)), Duration(0)}) {
    bench.operator_clock = set;
    bench.run(2.0);
  }
  bench.operator_clock = -hours(2);
  bench.run(2.0);
  EXPECT_TRUE(only_hovered());
  bench.send_command(OperatorAction::kLand);
  bench.run(0.1);
  EXPECT_EQ(bench.state(), FlightState::kLand);
  bench.send_command(OperatorAction::kEmergencyStop);
  bench.run(0.05);
  EXPECT_EQ(bench.state(), FlightState::kKilled);
}

// ---- Channel VICON ----

TEST_F(VehicleTrust, RefusesASecondMocap) {
  take_off();
  begin_second_mocap();
  bench.run(3.0);
  EXPECT_TRUE(only_hovered());
  EXPECT_GT(bench.count("mocap.other_source"), 100);
  EXPECT_TRUE(bench.has_reason(kSecondSource)) << "reported to the operator";
  bench.each_step = nullptr;
  bench.run(3.0);
  EXPECT_TRUE(only_hovered());
  EXPECT_TRUE(hovers());
}

// Regression, seen in a flight: a second trial with another scenario on the same network held three
// vehicles for ten seconds.
TEST_F(VehicleTrust, IgnoresTheMapOfASecondTrial) {
  take_off();
  const auto side = bench.hub.connect();
  bus::Bus second(*side, kOtherRun);
  bool is_announced = true;
  const auto announce_ours = [&] {
    models::ScenarioNotice notice;
    notice.stamp.time = bench.clock.now();
    notice.yaml = bench.scenario.source_text;
    bench.lab.publish(bus::kScenario, notice);
  };
  bench.node_bus.use_clock(bench.clock);  // as in the process of a real node
  announce_ours();
  bench.run(0.1);
  bench.each_step = [&] {
    models::ScenarioNotice notice;
    notice.stamp.time = bench.clock.now();
    if (bench.steps % 1000 == 0 && is_announced) {
      announce_ours();
    } else if (bench.steps % 100 == 50) {
      notice.yaml = "name: another\n";
      second.publish(bus::kScenario, notice);
    }
  };
  bench.statuses.clear();
  bench.run(16.0);
  EXPECT_TRUE(only_hovered());
  is_announced = false;
  bench.run(14.0);
  EXPECT_TRUE(bench.has_reason("map differs"));
}

// After a dropout of the first source, the second one must not stay in use.
TEST_F(VehicleTrust, ReturnsToTheFirstMocapAfterItsDropout) {
  take_off();
  begin_second_mocap();
  bench.mocap = nullptr;
  bench.run(0.4);
  bench.mocap = &bench.lab;
  bench.run(2.0);
  EXPECT_EQ(bench.state(), FlightState::kHold);
  EXPECT_TRUE(bench.has_reason(kSecondSource));
  bench.each_step = nullptr;
  bench.run(3.0);
  EXPECT_TRUE(hovers()) << words_of(bench.statuses.back().reasons);
  EXPECT_LT(bench.count("pose.jump"), 60)
      << "only poses of the second source while the first was silent";
}

TEST_F(VehicleTrust, AcceptsARestartedMocap) {
  take_off();
  const auto side = bench.hub.connect();
  bus::Bus again(*side, kOtherRun);
  bench.mocap = nullptr;
  bench.run(0.2);
  bench.mocap = &again;
  bench.run(3.0);
  EXPECT_TRUE(hovers()) << words_of(bench.statuses.back().reasons);
}

TEST_F(VehicleTrust, IgnoresAFrameWithAStampFarInTheFuture) {
  take_off();
  for (const std::int64_t run : {kOtherRun, kLabRun}) {
    models::MocapFrame frame = bench.see();
    frame.stamp = {bench.clock.now() + hours(24 * 3652), run, 1'000'000};
    bench.publish_forged(bus::kVicon, frame);
    bench.run(2.0);
  }
  EXPECT_TRUE(only_hovered());
}

TEST_F(VehicleTrust, AcceptsPosesAfterForgedSequenceNumbers) {
  take_off();
  models::MocapFrame frame = bench.see();
  frame.stamp = {bench.clock.now(), kLabRun, kFarAhead};
  bench.publish_forged(bus::kVicon, frame);
  bench.run(2.0);
  EXPECT_TRUE(only_hovered());
  EXPECT_EQ(bench.count("VICON.too_far_ahead"), 1);
}

TEST_F(VehicleTrust, ContinuesThroughAMocapClockChange) {
  take_off();
  for (const Duration set :
       {Duration(-hours(1)), Duration(hours(2)), Duration(0), Duration(-seconds(1)),
        Duration(-milliseconds(1'500)), Duration(-milliseconds(1'600))}) {
    bench.mocap_clock = set;
    bench.run(2.0);
  }
  EXPECT_TRUE(only_hovered());
}

TEST_F(VehicleTrust, IgnoresMocapOfAnOldLogOnTheGround) {
  stand();
  bench.mocap = nullptr;
  bench.run(1.0);
  ASSERT_TRUE(bench.has_reason("pose lost"));
  const auto side = bench.hub.connect();
  bus::Bus log(*side, kOtherRun);
  bench.mocap = &log;
  bench.mocap_clock = -hours(24);
  bench.run(3.0);
  EXPECT_TRUE(bench.has_reason("pose lost"));
  EXPECT_GT(bench.count("mocap.other_time"), 100);
  EXPECT_TRUE(bench.has_reason(kOtherClock));
  bench.mocap = &bench.lab;
  bench.mocap_clock = {};
  bench.run(3.0);
  EXPECT_TRUE(bench.statuses.back().reasons.empty());
}

// ---- Channel PLAN_Q1 ----

TEST_F(VehicleTrust, AcceptsAPlannerDespiteStalePlans) {
  take_off();
  bench.each_step = [&, sequence = std::int64_t{0}]() mutable {
    if (bench.steps % 100 == 0) {
      models::RobotPlan plan;
      plan.robot = bench.robot();
      plan.trajectory.start_time = bench.clock.now() - hours(24);
      plan.stamp = {plan.trajectory.start_time, kOtherRun, sequence++};
      bench.publish_forged(bus::plan_channel(bench.robot()), plan);
    }
  };
  bench.run(5.0);
  const auto side = bench.hub.connect();
  bus::Bus planner(*side, 77);
  for (int round = 0; round < 5; ++round) {
    models::RobotPlan plan;
    plan.robot = bench.robot();
    plan.round = round;
    plan.trajectory.start_time = bench.clock.now() + from_seconds(0.5);
    plan.trajectory.start = {2.0, 2.0, kPi / 2};
    plan.trajectory.height_m = 1.0;
    plan.stamp.time = plan.trajectory.start_time;
    planner.publish(bus::plan_channel(bench.robot()), plan);
    bench.run(1.0);
  }
  EXPECT_EQ(bench.count("plan.no lease"), 0);
  EXPECT_EQ(bench.count("plan.not following"), 5)
      << "evaluated and refused, because the vehicle only hovers";
  EXPECT_GT(bench.count("plan.stale"), 10);
  EXPECT_FALSE(bench.has_reason("two planners"));
}

}  // namespace
}  // namespace vantage::drivers
