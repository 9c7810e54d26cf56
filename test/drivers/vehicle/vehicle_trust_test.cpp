// Who a flying vehicle believes, through its node and a real bus: forged numbers, old logs, a
// second mocap, clocks that are set.

#include <algorithm>
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "bus/auth/trailer.hpp"
#include "bus/convert/channels.hpp"
#include "bus/convert/wire_walk.hpp"
#include "drivers/quadrotor/app/node.hpp"
#include "sim/autopilot/endpoint.hpp"
#include "test/bus/auth/auth_support.hpp"
#include "test/drivers/quadrotor/flight_bench.hpp"
#include "test/drivers/vehicle/vehicle_node_bench.hpp"
#include "test/support/udp_port.hpp"

namespace vantage::drivers {
namespace {

using models::AutopilotDialect;
using models::FlightState;
using models::OperatorAction;
using std::chrono::hours;
using test::FlightBench;
using test::port_of_this_test;

constexpr std::int64_t kLabRun = 22;  // of the bench: mocap and operator
constexpr std::int64_t kOtherRun = 5;
constexpr const char* kSecondSource = "a second source of VICON is refused";
constexpr const char* kOtherClock = "VICON stamped by another clock, or of a log, is refused";
constexpr std::int64_t kFarAhead = std::int64_t{1} << 62;

struct NodeBench : test::VehicleNodeBench<QuadrotorNode, sim::AutopilotEndpoint> {
  explicit NodeBench(const std::string& url)
      : VehicleNodeBench(FlightBench::scenario_for(AutopilotDialect::kPx4),
                         FlightBench::vehicle_for(AutopilotDialect::kPx4), url, FlightBench::kStart,
                         [](const sim::AutopilotEndpoint& quadrotor) {
                           return quadrotor.emulator().world_from_body();
                         }) {}
  [[nodiscard]] double height_m() const {
    return vehicle.emulator().world_from_body().translation_m.z();
  }
  [[nodiscard]] FlightState state() const {
    return statuses.empty() ? FlightState::kIdle : statuses.back().state;
  }
  [[nodiscard]] bool says(const std::string& reason) const {
    const auto& reasons = statuses.back().reasons;
    return std::find(reasons.begin(), reasons.end(), reason) != reasons.end();
  }
  [[nodiscard]] std::int64_t count(const std::string& name) const {
    std::int64_t out = 0;
    for (const models::NamedCount& counter : node.counters()) {
      out += counter.name == name ? counter.count : 0;
    }
    for (const models::NamedCount& counter : node_bus.counters()) {
      out += counter.name == name ? counter.count : 0;
    }
    return out;
  }
};

class VehicleTrust : public ::testing::Test {
 protected:
  void stand() {
    ASSERT_TRUE(bench.run_until(
        [&] { return !bench.statuses.empty() && bench.statuses.back().reasons.empty(); }, 20.0));
  }
  void take_off() {
    stand();
    bench.say(OperatorAction::kArm);
    ASSERT_TRUE(
        bench.run_until([&] { return bench.vehicle.emulator().controller().is_armed(); }, 40.0));
    bench.run(1.5);
    bench.say(OperatorAction::kTakeOff);
    ASSERT_TRUE(bench.run_until([&] { return bench.height_m() > 0.9; }, 15.0));
    bench.run(3.0);
    bench.statuses.clear();
    bench.run(0.2);
    ASSERT_EQ(bench.state(), FlightState::kHold);
    hovering_ = bench.statuses.back().reasons;
  }
  models::OperatorCommand command(OperatorAction action, std::int64_t run, std::int64_t sequence,
                                  Duration age) const {
    models::OperatorCommand out;
    out.stamp = {bench.clock.now() - age, run, sequence};
    out.action = action;
    return out;
  }
  /// Whether nothing else was reported since take_off().
  [[nodiscard]] testing::AssertionResult only_hovered() const {
    for (models::VehicleStatus status : bench.statuses) {
      std::erase(status.reasons, kSecondSource);
      std::erase(status.reasons, kOtherClock);
      if (status.state != FlightState::kHold || status.reasons != hovering_) {
        return testing::AssertionFailure() << name_of(status.state) << words_of(status.reasons)
                                           << ", not hold" << words_of(hovering_);
      }
    }
    return testing::AssertionSuccess();
  }
  [[nodiscard]] bool hovers() const {
    return bench.state() == FlightState::kHold && bench.statuses.back().reasons == hovering_;
  }
  static std::string words_of(const std::vector<std::string>& reasons) {
    std::string out;
    for (const std::string& reason : reasons) {
      out += ", " + reason;
    }
    return out;
  }

  NodeBench bench{"udp://127.0.0.1:" + port_of_this_test(0)};
  std::vector<std::string> hovering_;  ///< what the vehicle says when all is well
};

// COMMAND

TEST_F(VehicleTrust, ForgedNumbersDoNotSilenceTheOperatorsStop) {
  take_off();
  bench.forge(bus::kCommand, command(OperatorAction::kHeartbeat, kLabRun, kFarAhead, {}));
  bench.forge(bus::kCommand, command(OperatorAction::kHeartbeat, kLabRun,
                                     std::numeric_limits<std::int64_t>::max(), Duration{1}));
  bench.run(5.0);
  EXPECT_TRUE(only_hovered()) << "and the true heartbeat goes on counting";
  bench.say(OperatorAction::kEmergencyStop);
  bench.run(0.05);
  EXPECT_EQ(bench.state(), FlightState::kKilled);
}

TEST_F(VehicleTrust, AStopPassesThoughItIsOvertakenOrItsNumberWasUsed) {
  take_off();
  bench.forge(bus::kCommand, command(OperatorAction::kEmergencyStop, kLabRun, 3, {}));
  bench.run(0.05);
  EXPECT_EQ(bench.state(), FlightState::kKilled);
}

TEST_F(VehicleTrust, AStopOfYesterdayStopsNobody) {
  take_off();
  for (const OperatorAction action :
       {OperatorAction::kHold, OperatorAction::kLand, OperatorAction::kEmergencyStop}) {
    bench.forge(bus::kCommand, command(action, kOtherRun, 0, hours(24)));
    bench.run(0.5);
    EXPECT_EQ(bench.state(), FlightState::kHold);
  }
  EXPECT_TRUE(only_hovered());
  EXPECT_EQ(bench.count("command.refused"), 3);
}

TEST_F(VehicleTrust, AnOldLogWithItsOwnHeartbeatsStopsNobody) {
  take_off();
  std::int64_t sequence = 500;
  bench.each_step = [&] {
    if (bench.steps % 40 == 0) {
      bench.forge(bus::kCommand,
                  command(OperatorAction::kHeartbeat, kOtherRun, sequence++, hours(24)));
    }
    if (bench.steps % 100 == 99) {
      bench.forge(bus::kCommand,
                  command(OperatorAction::kEmergencyStop, kOtherRun, sequence++, hours(24)));
      bench.forge(bus::kCommand, command(OperatorAction::kLand, kOtherRun, sequence++, hours(24)));
    }
  };
  bench.run(5.0);
  EXPECT_TRUE(only_hovered());
}

TEST_F(VehicleTrust, TheLiveOperatorsOwnOldWordsAreNotObeyedAgain) {
  take_off();
  for (const OperatorAction action : {OperatorAction::kLand, OperatorAction::kEmergencyStop}) {
    bench.forge(bus::kCommand, command(action, kLabRun, 5, std::chrono::seconds(30)));
    bench.run(0.2);
  }
  EXPECT_TRUE(only_hovered());
}

TEST_F(VehicleTrust, AnOperatorWhoseClockIsSetStaysInCharge) {
  take_off();
  for (const Duration set :
       {Duration(-std::chrono::seconds(3)), Duration(-hours(1)), Duration(hours(1)), Duration(0)}) {
    bench.operator_clock = set;
    bench.run(2.0);
  }
  bench.operator_clock = -hours(2);
  bench.run(2.0);
  EXPECT_TRUE(only_hovered());
  bench.say(OperatorAction::kLand);
  bench.run(0.1);
  EXPECT_EQ(bench.state(), FlightState::kLand);
  bench.say(OperatorAction::kEmergencyStop);
  bench.run(0.05);
  EXPECT_EQ(bench.state(), FlightState::kKilled);
}

// VICON

TEST_F(VehicleTrust, ASecondMocapBesideTheFlightIsRefusedAndTheTrueOneIsNot) {
  take_off();
  const auto side = bench.hub.connect();
  bus::Bus second(*side, kOtherRun);
  bench.each_step = [&] {
    if (bench.steps % 2 == 1) {
      models::MocapFrame frame = bench.see();
      frame.bodies[0].world_from_body.translation_m = {-1.0, 1.0, 0.05};
      second.publish(bus::kVicon, frame);
    }
  };
  bench.run(3.0);
  EXPECT_TRUE(only_hovered());
  EXPECT_GT(bench.count("mocap.other_source"), 100);
  EXPECT_TRUE(bench.says(kSecondSource)) << "the operator is told";
  bench.each_step = nullptr;
  bench.run(3.0);
  EXPECT_TRUE(only_hovered());
  EXPECT_TRUE(hovers());
}

// Flown: a second trial of another scenario on the network held three vehicles for ten seconds.
TEST_F(VehicleTrust, TheMapOfASecondTrialHoldsNobodyWhileTheFirstIsAnnounced) {
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
  bench.node_bus.keep_time(bench.clock);  // as a node's process does
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
  EXPECT_TRUE(bench.says("map differs"));
}

// The second one must not stay because the first faltered.
TEST_F(VehicleTrust, TheMocapOfTheFlightIsBelievedAgainAtOnceWhenItComesBack) {
  take_off();
  const auto side = bench.hub.connect();
  bus::Bus second(*side, kOtherRun);
  bench.each_step = [&] {
    if (bench.steps % 2 == 1) {
      models::MocapFrame frame = bench.see();
      frame.bodies[0].world_from_body.translation_m = {-1.0, 1.0, 0.05};
      second.publish(bus::kVicon, frame);
    }
  };
  bench.mocap = nullptr;
  bench.run(0.4);
  bench.mocap = &bench.lab;
  bench.run(2.0);
  EXPECT_EQ(bench.state(), FlightState::kHold);
  EXPECT_TRUE(bench.says(kSecondSource));
  bench.each_step = nullptr;
  bench.run(3.0);
  EXPECT_TRUE(hovers()) << words_of(bench.statuses.back().reasons);
  EXPECT_LT(bench.count("pose.jump"), 60) << "of the second's while the first was silent, no more";
}

TEST_F(VehicleTrust, AMocapThatIsStartedAgainTakesOverFromTheOldOnesSilence) {
  take_off();
  const auto side = bench.hub.connect();
  bus::Bus again(*side, kOtherRun);
  bench.mocap = nullptr;
  bench.run(0.2);
  bench.mocap = &again;
  bench.run(3.0);
  EXPECT_TRUE(hovers()) << words_of(bench.statuses.back().reasons);
}

TEST_F(VehicleTrust, OneFrameOfTheFarFutureTakesNoPoseAway) {
  take_off();
  for (const std::int64_t run : {kOtherRun, kLabRun}) {
    models::MocapFrame frame = bench.see();
    frame.stamp = {bench.clock.now() + hours(24 * 3652), run, 1'000'000};
    bench.forge(bus::kVicon, frame);
    bench.run(2.0);
  }
  EXPECT_TRUE(only_hovered());
}

TEST_F(VehicleTrust, ForgedNumbersTakeNoPoseAway) {
  take_off();
  models::MocapFrame frame = bench.see();
  frame.stamp = {bench.clock.now(), kLabRun, kFarAhead};
  bench.forge(bus::kVicon, frame);
  bench.run(2.0);
  EXPECT_TRUE(only_hovered());
  EXPECT_EQ(bench.count("VICON.too_far_ahead"), 1);
}

TEST_F(VehicleTrust, AMocapClockThatIsSetInFlightGroundsNobody) {
  take_off();
  for (const Duration set : {Duration(-hours(1)), Duration(hours(2)), Duration(0)}) {
    bench.mocap_clock = set;
    bench.run(2.0);
  }
  EXPECT_TRUE(only_hovered());
}

TEST_F(VehicleTrust, AnOldLogsMocapEndsNoLossOfPoseOnTheGround) {
  stand();
  bench.mocap = nullptr;
  bench.run(1.0);
  ASSERT_TRUE(bench.says("pose lost"));
  const auto side = bench.hub.connect();
  bus::Bus log(*side, kOtherRun);
  bench.mocap = &log;
  bench.mocap_clock = -hours(24);
  bench.run(3.0);
  EXPECT_TRUE(bench.says("pose lost"));
  EXPECT_GT(bench.count("mocap.other_time"), 100);
  EXPECT_TRUE(bench.says(kOtherClock));
  bench.mocap = &bench.lab;
  bench.mocap_clock = {};
  bench.run(3.0);
  EXPECT_TRUE(bench.statuses.back().reasons.empty());
}

// PLAN

TEST_F(VehicleTrust, StalePlansOfAnOldLogKeepNoPlannerOut) {
  take_off();
  bench.each_step = [&, sequence = std::int64_t{0}]() mutable {
    if (bench.steps % 100 == 0) {
      models::RobotPlan plan;
      plan.robot = bench.robot();
      plan.trajectory.start_time = bench.clock.now() - hours(24);
      plan.stamp = {plan.trajectory.start_time, kOtherRun, sequence++};
      bench.forge(bus::plan_channel(bench.robot()), plan);
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
  EXPECT_EQ(bench.count("plan.not following"), 5) << "judged, as the vehicle only hovers";
  EXPECT_GT(bench.count("plan.stale"), 10);
  EXPECT_FALSE(bench.says("two planners"));
}

// What nobody can tell from the true words without keys: the run ids and the next numbers of the
// live stream, stamped now.

class ForgedInThisSession : public VehicleTrust {
 protected:
  static constexpr std::int64_t kPlannerRun = 77;

  /// Forges what hears the flight and speaks in its name for three seconds.
  void forge_poses() {
    const auto ear = listen();
    bench.each_step = [&] {
      follow(*ear);
      if (bench.steps % 2 == 1) {
        models::MocapFrame frame = bench.see();
        frame.stamp = {bench.clock.now(), vicon_.run_id, vicon_.sequence + 1};
        frame.bodies[0].world_from_body.translation_m.x() += 0.02 * static_cast<double>(++forged_);
        send(bus::kVicon.name, bytes_of(frame));
      }
    };
    bench.run(3.0);
    bench.each_step = nullptr;
  }
  void forge_order(OperatorAction action) {
    const auto ear = listen();
    bench.each_step = [&] { follow(*ear); };
    bench.run(0.5);
    bench.each_step = nullptr;
    send(bus::kCommand.name, bytes_of(command(action, command_.run_id, command_.sequence + 1, {})));
    bench.run(0.5);
  }
  /// The payload alone, and dressed in the newest trailer that was heard on the channel.
  void send(const std::string& channel, const std::vector<std::uint8_t>& payload) {
    bench.stranger->publish(channel, payload);
    std::vector<std::uint8_t> dressed = payload;
    const std::vector<std::uint8_t>& whole = newest_[channel];
    const std::size_t trailer_bytes = whole.size() - bus::auth::payload_of(whole).size();
    dressed.insert(dressed.end(), whole.end() - static_cast<std::ptrdiff_t>(trailer_bytes),
                   whole.end());
    if (trailer_bytes > 0) {
      bench.stranger->publish(channel, dressed);
      bench.stranger->publish(channel, whole);  // and the true one again
    }
  }
  template <class Message>
  static std::vector<std::uint8_t> bytes_of(const Message& message) {
    const auto wire = bus::to_wire(message);
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(wire.getEncodedSize()));
    wire.encode(bytes.data(), 0, wire.getEncodedSize());
    return bytes;
  }
  std::unique_ptr<bus::Transport> listen() {
    auto ear = bench.hub.connect();
    for (const std::string& channel : {bus::kVicon.name, bus::kCommand.name}) {
      ear->subscribe(channel, [this](std::string_view name, std::span<const std::uint8_t> bytes) {
        newest_[std::string(name)] = {bytes.begin(), bytes.end()};
      });
    }
    return ear;
  }
  void follow(bus::Transport& ear) {
    while (ear.handle(std::chrono::microseconds(0)) > 0) {
    }
    if (const auto frame = bus::decode_wire<vantage_lcm::vicon_frame_t>(newest_["VICON"])) {
      vicon_ = {from_utime(frame->utime), frame->run_id, frame->sequence};
    }
    if (const auto order = bus::decode_wire<vantage_lcm::command_t>(newest_["COMMAND"])) {
      command_ = {from_utime(order->utime), order->run_id, order->sequence};
    }
  }
  /// A plan that begins where the vehicle hovers, now.
  models::RobotPlan plan() const {
    models::RobotPlan plan;
    plan.robot = bench.robot();
    plan.trajectory.start_time = bench.clock.now() + from_seconds(0.5);
    plan.trajectory.start = {2.0, 2.0, kPi / 2};
    plan.trajectory.height_m = 1.0;
    plan.stamp = {plan.trajectory.start_time, kPlannerRun, 0};
    return plan;
  }

  models::Stamp vicon_;
  models::Stamp command_;
  std::map<std::string, std::vector<std::uint8_t>> newest_;
  std::int64_t forged_ = 0;
};

TEST_F(ForgedInThisSession, PosesSteerAVehicleThatAsksForNoSignature) {
  take_off();
  forge_poses();
  EXPECT_FALSE(only_hovered());
}

TEST_F(ForgedInThisSession, PosesSteerNobodyWhereTheyMustBeSigned) {
  bench.secure(test::keys_of_a_trial(), {});
  take_off();
  forge_poses();
  EXPECT_TRUE(only_hovered());
  EXPECT_GT(bench.count("VICON.unsigned"), 200);
  EXPECT_GT(bench.count("VICON.bad_mac"), 200);
  EXPECT_GT(bench.count("VICON.replayed"), 200);
}

TEST_F(ForgedInThisSession, OrdersAreObeyedByAVehicleThatAsksForNoSignature) {
  take_off();
  forge_order(OperatorAction::kEmergencyStop);
  EXPECT_EQ(bench.state(), FlightState::kKilled);
}

TEST_F(ForgedInThisSession, OrdersAreObeyedByNobodyWhereTheyMustBeSigned) {
  bench.secure(test::keys_of_a_trial(), {});
  take_off();
  for (const OperatorAction action :
       {OperatorAction::kLand, OperatorAction::kEmergencyStop, OperatorAction::kArm}) {
    forge_order(action);
  }
  EXPECT_TRUE(only_hovered());
  EXPECT_EQ(bench.count("COMMAND.unsigned"), 3);
  EXPECT_EQ(bench.count("COMMAND.bad_mac"), 3);
  EXPECT_EQ(bench.count("COMMAND.replayed"), 3);
  bench.say(OperatorAction::kEmergencyStop);
  bench.run(0.05);
  EXPECT_EQ(bench.state(), FlightState::kKilled) << "the true one's is";
}

TEST_F(ForgedInThisSession, PlansReachNoVehicleWhereTheyMustBeSigned) {
  const std::string channel = bus::plan_channel(bench.robot()).name;
  take_off();
  send(channel, bytes_of(plan()));
  bench.run(0.1);
  EXPECT_EQ(bench.count("plan.not following"), 1) << "judged by who asks for no signature";
  bench.secure(test::keys_of_a_trial(), {});
  bench.run(0.5);
  send(channel, bytes_of(plan()));
  bench.run(0.1);
  EXPECT_EQ(bench.count("plan.not following"), 1);
  EXPECT_EQ(bench.count(channel + ".unsigned"), 1);
}

TEST_F(ForgedInThisSession, ALiveVehicleTakesNoWordOfASimulationWithItsKeys) {
  const auto keys = test::keys_of_a_trial();
  bench.secure(keys, {});
  take_off();
  const auto side = bench.hub.connect();
  bus::Bus simulation(*side, kOtherRun);
  simulation.secure(test::authenticator(
                        keys, {scenario::SecurityMode::kRequire, scenario::TrialMode::kSimulation}),
                    bench.clock);
  bench.each_step = [&] {
    models::MocapFrame frame = bench.see();
    frame.bodies[0].world_from_body.translation_m = {-1.0, 1.0, 0.05};
    simulation.publish(bus::kVicon, frame);
    simulation.publish(bus::kCommand, command(OperatorAction::kEmergencyStop, 0, 0, {}));
  };
  bench.run(3.0);
  EXPECT_TRUE(only_hovered());
  EXPECT_GT(bench.count("VICON.wrong_mode"), 500);
  EXPECT_GT(bench.count("COMMAND.wrong_mode"), 500);
  EXPECT_FALSE(bench.says(kSecondSource));
}

}  // namespace
}  // namespace vantage::drivers
