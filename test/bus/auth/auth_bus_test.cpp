#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/auth/authenticator.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "test/bus/auth/auth_support.hpp"
#include "test/bus/convert/message_types.hpp"

// Signing and verification within the bus, without involvement of the nodes.

namespace vantage::bus {
namespace {

using auth::Authenticator;
using models::OperatorAction;
using scenario::SecurityMode;
using scenario::TrialMode;

constexpr std::chrono::microseconds kNoWait{0};
constexpr Time kStart = Time{Duration{1'700'000'000'000'000}};

/// One process of a trial.
struct Process {
  Process(InProcessHub& hub, VirtualClock& clock, std::int64_t run,
          std::unique_ptr<Authenticator> authenticator)
      : transport(hub.connect()), bus(*transport, run) {
    bus.secure(std::move(authenticator), clock);
    bus.subscribe<models::MocapFrame>(kVicon,
                                      [this](const models::MocapFrame& f) { frames.push_back(f); });
    bus.subscribe<models::OperatorCommand>(
        kCommand, [this](const models::OperatorCommand& c) { commands.push_back(c); });
    bus.subscribe<models::VehicleStatus>(
        vehicle_channel("*"), [this](const models::VehicleStatus& s) { statuses.push_back(s); });
    bus.subscribe<models::ProcessHealth>(health_channel("*"),
                                         [this](const models::ProcessHealth&) { ++healths; });
    bus.subscribe<models::HostReport>(host_channel("*"),
                                      [this](const models::HostReport&) { ++hosts; });
    bus.subscribe<models::CollisionReport>(kCollision,
                                           [this](const models::CollisionReport&) { ++contacts; });
  }
  void handle_all() {
    while (bus.handle(kNoWait) > 0) {
    }
  }
  [[nodiscard]] std::int64_t count(const std::string& name) const {
    for (const models::NamedCount& counter : bus.counters()) {
      if (counter.name == name) {
        return counter.count;
      }
    }
    return 0;
  }

  std::unique_ptr<Transport> transport;
  Bus bus;
  std::vector<models::MocapFrame> frames;
  std::vector<models::OperatorCommand> commands;
  std::vector<models::VehicleStatus> statuses;
  int healths = 0;
  int hosts = 0;
  int contacts = 0;
};

class SecuredBus : public ::testing::Test {
 protected:
  SecuredBus() {
    tap_->subscribe("*", [this](std::string_view channel, std::span<const std::uint8_t> bytes) {
      recorded_.push_back({std::string(channel), {bytes.begin(), bytes.end()}});
    });
    vehicle_.bus.act_as_vehicle("Q1");
  }
  void handle_all() {
    while (tap_->handle(kNoWait) > 0) {
    }
    for (Process* process : {&lab_, &vehicle_, &station_}) {
      process->handle_all();
    }
  }
  void pass(Duration time) { clock_.set(clock_.now() + time); }
  models::MocapFrame frame() const {
    models::MocapFrame frame;
    frame.stamp.time = frame.arrival = clock_.now();
    return frame;
  }
  void send_order(OperatorAction action, const std::string& robot = "") {
    models::OperatorCommand command;
    command.stamp.time = clock_.now();
    command.action = action;
    command.robot = robot;
    station_.bus.publish(kCommand, command);
    handle_all();
  }
  void publish_status(Bus& bus) {
    models::VehicleStatus status;
    status.stamp.time = clock_.now();
    status.robot = "Q1";
    bus.publish(vehicle_channel("Q1"), status);
    handle_all();
  }
  void send_again(const std::pair<std::string, std::vector<std::uint8_t>>& message) {
    tap_->publish(message.first, message.second);
    handle_all();
  }
  void forge(const std::string& channel, const std::vector<std::uint8_t>& bytes) {
    send_again({channel, bytes});
  }

  InProcessHub hub_;
  VirtualClock clock_{kStart};
  std::shared_ptr<const auth::Keyring> keys_ = test::keys_of_a_trial();
  std::unique_ptr<Transport> tap_ = hub_.connect();
  std::vector<std::pair<std::string, std::vector<std::uint8_t>>> recorded_;
  Process lab_{hub_, clock_, 1, test::authenticator(keys_)};
  Process vehicle_{hub_, clock_, 2, test::authenticator(keys_)};
  Process station_{hub_, clock_, 3, test::authenticator(keys_)};
};

TEST_F(SecuredBus, SignedMessagesAreReadableWithAndWithoutKeys) {
  Process viewer(hub_, clock_, 9, nullptr);
  EXPECT_FALSE(viewer.bus.receives_signed());
  lab_.bus.publish(kVicon, frame());
  handle_all();
  viewer.handle_all();
  ASSERT_EQ(vehicle_.frames.size(), 1U);
  EXPECT_EQ(viewer.frames.size(), 1U);
  EXPECT_TRUE(viewer.bus.receives_signed());
  EXPECT_EQ(vehicle_.count("VICON.fresh"), 1);
  // The payload is byte for byte the same as without keys.
  models::MocapFrame sent = frame();
  sent.stamp.run_id = 1;
  const auto payload = auth::payload_of(recorded_.at(0).second);
  EXPECT_EQ(std::vector<std::uint8_t>(payload.begin(), payload.end()), test::encoded(sent));
}

// The run id, the next number and the current time are readable on the network, so a forged frame
// can contain them.
TEST_F(SecuredBus, RefusesAForgedFrameWithTheCorrectRunIdAndSequenceNumber) {
  lab_.bus.publish(kVicon, frame());
  handle_all();
  models::MocapFrame forged = frame();
  forged.stamp = {clock_.now(), 1, 1};
  forge("VICON", test::encoded(forged));
  EXPECT_EQ(vehicle_.frames.size(), 1U);
  EXPECT_EQ(vehicle_.count("VICON.unsigned"), 1);
  // The second forgery ends with the trailer of the genuine message.
  std::vector<std::uint8_t> with_trailer = test::encoded(forged);
  const auto& whole = recorded_.at(0).second;
  with_trailer.insert(with_trailer.end(),
                      whole.begin() + static_cast<std::ptrdiff_t>(auth::payload_of(whole).size()),
                      whole.end());
  forge("VICON", with_trailer);
  EXPECT_EQ(vehicle_.frames.size(), 1U);
  EXPECT_EQ(vehicle_.count("VICON.bad_mac"), 1);
  lab_.bus.publish(kVicon, frame());
  handle_all();
  EXPECT_EQ(vehicle_.frames.size(), 2U) << "the genuine frame is still accepted";
  EXPECT_EQ(vehicle_.count("VICON.duplicates"), 0);
}

TEST_F(SecuredBus, RefusesMessagesSignedWithKeysOfAnotherTrial) {
  Process other(hub_, clock_, 4, test::authenticator(test::keys_of_a_trial(7)));
  other.bus.publish(kVicon, frame());
  handle_all();
  EXPECT_TRUE(vehicle_.frames.empty());
  EXPECT_EQ(vehicle_.count("VICON.unknown_key"), 1);
}

TEST_F(SecuredBus, RefusesMessagesOfSimulationsAndReplaysWithTheSameKeys) {
  Process simulation(hub_, clock_, 4,
                     test::authenticator(keys_, {SecurityMode::kRequire, TrialMode::kSimulation}));
  Process replay(hub_, clock_, 5,
                 test::authenticator(keys_, {SecurityMode::kRequire, TrialMode::kLive, true}));
  simulation.bus.publish(kVicon, frame());
  replay.bus.publish(kVicon, frame());
  handle_all();
  EXPECT_TRUE(vehicle_.frames.empty());
  EXPECT_EQ(vehicle_.count("VICON.wrong_mode"), 2);
  lab_.bus.publish(kVicon, frame());
  simulation.handle_all();
  replay.handle_all();
  EXPECT_EQ(simulation.count("VICON.wrong_mode"), 2)
      << "a simulation refuses frames of the real lab";
  EXPECT_EQ(replay.frames.size(), 3U) << "a replay accepts messages of any time";
}

TEST_F(SecuredBus, RefusesMessagesReplayedImmediatelyOrLater) {
  lab_.bus.publish(kVicon, frame());
  handle_all();
  send_again(recorded_.at(0));
  EXPECT_EQ(vehicle_.count("VICON.replayed"), 1);
  pass(std::chrono::seconds(3));
  Process late(hub_, clock_, 6, test::authenticator(keys_));
  send_again(recorded_.at(0));
  late.handle_all();
  EXPECT_TRUE(late.frames.empty()) << "this receiver has not received the message before";
  EXPECT_EQ(late.count("VICON.stale"), 1);
}

TEST_F(SecuredBus, AcceptsUnsignedMessagesOnNoncriticalChannels) {
  const Channel<models::HostReport> camera{"CAMERA"};
  int received = 0;
  vehicle_.bus.subscribe<models::HostReport>(camera, [&](const auto&) { ++received; });
  models::HostReport report;
  report.stamp = {clock_.now(), 77, 0};
  report.host = "CAMERA";
  forge("CAMERA", test::encoded(report));
  EXPECT_EQ(received, 1);
  EXPECT_EQ(vehicle_.count("CAMERA.unsigned"), 0);
}

// A forged HEALTH would keep the supervisor from ending a hung process, a forged HOST would keep a
// trial from starting, and a forged COLLISION would decide the exit code.
TEST_F(SecuredBus, RefusesAndCountsUnsignedMessagesOnCriticalChannels) {
  const auto check = [this](const auto& channel, auto message, const int& received) {
    message.stamp = {clock_.now(), 77, 0};
    forge(channel.name, test::encoded(message));
    EXPECT_EQ(received, 0) << channel.name;
    EXPECT_EQ(vehicle_.count(channel.name + ".unsigned"), 1);
    lab_.bus.publish(channel, message);
    handle_all();
    EXPECT_EQ(received, 1) << channel.name;
  };
  models::ProcessHealth health;
  health.process = "PLANNER_Q1";
  check(health_channel("PLANNER_Q1"), health, vehicle_.healths);
  models::HostReport report;
  report.host = "LAB";
  check(host_channel("LAB"), report, vehicle_.hosts);
  models::CollisionReport contact;
  contact.body_a = "Q1";
  contact.body_b = "bounds";
  check(kCollision, contact, vehicle_.contacts);
}

// A console or `vantage check --live` must not accept a replayed status as that of a live vehicle.
TEST_F(SecuredBus, ChecksTheTimeOfStatusesByDefault) {
  publish_status(vehicle_.bus);
  ASSERT_EQ(station_.statuses.size(), 1U);
  const auto recorded = recorded_.back();
  pass(std::chrono::seconds(10));
  Process console(hub_, clock_, 9, test::authenticator(keys_));
  send_again(recorded);
  console.handle_all();
  EXPECT_TRUE(console.statuses.empty());
  EXPECT_EQ(console.count("VEHICLE_Q1.stale"), 1);
}

TEST_F(SecuredBus, WarnsButAcceptsInWarnMode) {
  Process warned(hub_, clock_, 6, test::authenticator(keys_, {SecurityMode::kWarn}));
  models::MocapFrame stranger = frame();
  stranger.stamp = {clock_.now(), 77, 0};
  forge("VICON", test::encoded(stranger));
  warned.handle_all();
  EXPECT_EQ(warned.frames.size(), 1U);
  EXPECT_EQ(warned.count("VICON.unsigned"), 1);
}

TEST_F(SecuredBus, CountsMessagesWithoutASigningKey) {
  auto keys = std::make_shared<auth::Keyring>();
  keys->add(test::key_of(auth::Role::kNode, 9));
  Process poor(hub_, clock_, 6, test::authenticator(keys));
  poor.bus.publish(kVicon, frame());
  EXPECT_EQ(poor.count("VICON.no_key"), 1);
}

TEST_F(SecuredBus, RotatesKeysWhileRunning) {
  auto both = std::make_shared<auth::Keyring>();
  both->add(test::key_of(auth::Role::kMocap, 40));
  auth::Key next = test::key_of(auth::Role::kMocap, 200);
  next.use = auth::KeyUse::kNext;
  both->add(std::move(next));
  Process receiver(hub_, clock_, 6, test::authenticator(both));
  auto turned = std::make_shared<auth::Keyring>();
  turned->add(test::key_of(auth::Role::kMocap, 200));
  Process late(hub_, clock_, 1, test::authenticator(turned));
  lab_.bus.publish(kVicon, frame());
  receiver.handle_all();
  models::MocapFrame second = frame();
  late.bus.publish(kVicon, second);
  late.bus.publish(kVicon, second);
  receiver.handle_all();
  EXPECT_EQ(receiver.frames.size(), 2U)
      << "one message with the old key, one with the new (message 0 was received earlier)";
}

// ---- Messages on COMMAND ----

TEST_F(SecuredBus, CommandReachesTheVehicleWhoseNonceWasReceived) {
  publish_status(vehicle_.bus);
  send_order(OperatorAction::kHeartbeat);
  send_order(OperatorAction::kTakeOff, "Q1");
  ASSERT_EQ(vehicle_.commands.size(), 2U);
  EXPECT_EQ(vehicle_.commands[1].action, OperatorAction::kTakeOff);
  EXPECT_EQ(vehicle_.count("COMMAND.wrong_destination"), 0);
}

TEST_F(SecuredBus, CommandWithoutTheVehiclesNonceMayOnlyHoldLandOrStop) {
  for (const OperatorAction action :
       {OperatorAction::kHeartbeat, OperatorAction::kArm, OperatorAction::kTakeOff,
        OperatorAction::kFollow, OperatorAction::kHold, OperatorAction::kLand,
        OperatorAction::kEmergencyStop}) {
    send_order(action);
  }
  ASSERT_EQ(vehicle_.commands.size(), 3U);
  EXPECT_EQ(vehicle_.commands[0].action, OperatorAction::kHold);
  EXPECT_EQ(vehicle_.commands[2].action, OperatorAction::kEmergencyStop);
  EXPECT_EQ(vehicle_.count("COMMAND.wrong_destination"), 4);
  EXPECT_EQ(vehicle_.count("COMMAND.lost"), 0);
}

TEST_F(SecuredBus, IgnoresCommandsToAnotherVehicle) {
  publish_status(vehicle_.bus);
  send_order(OperatorAction::kArm, "Q2");
  send_order(OperatorAction::kHeartbeat);
  EXPECT_EQ(vehicle_.commands.size(), 1U);
  EXPECT_EQ(vehicle_.count("COMMAND.wrong_destination"), 0);
  EXPECT_EQ(vehicle_.count("COMMAND.lost"), 0);
}

// After a restart of the vehicle process, or after arming, commands recorded earlier are refused.
TEST_F(SecuredBus, RefusesCommandsOfAnEarlierSession) {
  publish_status(vehicle_.bus);
  Process again(hub_, clock_, 7, test::authenticator(keys_));
  again.bus.act_as_vehicle("Q1");
  send_order(OperatorAction::kArm, "Q1");
  again.handle_all();
  EXPECT_TRUE(again.commands.empty());
  EXPECT_EQ(again.count("COMMAND.wrong_session"), 1);

  vehicle_.bus.renew_session();
  send_order(OperatorAction::kTakeOff, "Q1");
  EXPECT_EQ(vehicle_.commands.size(), 2U) << "sent before the station had received the status";
  pass(std::chrono::milliseconds(1'100));
  send_order(OperatorAction::kTakeOff, "Q1");
  EXPECT_EQ(vehicle_.commands.size(), 2U);
  EXPECT_EQ(vehicle_.count("COMMAND.wrong_session"), 1);
  publish_status(vehicle_.bus);
  send_order(OperatorAction::kTakeOff, "Q1");
  EXPECT_EQ(vehicle_.commands.size(), 3U);
}

TEST_F(SecuredBus, ReplayedStatusesDoNotReplaceTheCurrentNonce) {
  publish_status(vehicle_.bus);
  const auto old = recorded_.back();
  pass(std::chrono::seconds(1));
  vehicle_.bus.renew_session();
  publish_status(vehicle_.bus);
  Process second(hub_, clock_, 8, test::authenticator(keys_));  // has received no status yet
  publish_status(vehicle_.bus);
  second.handle_all();
  send_again(old);
  second.handle_all();
  pass(std::chrono::milliseconds(1'500));
  models::OperatorCommand command;
  command.stamp.time = clock_.now();
  command.action = OperatorAction::kArm;
  second.bus.publish(kCommand, command);
  handle_all();
  EXPECT_EQ(vehicle_.commands.size(), 1U);
}

// A process that can verify commands cannot sign them: an attacker who has captured a vehicle has
// every key except the seed.
TEST_F(SecuredBus, ProcessWithoutSeedCannotSignCommands) {
  auto keys = std::make_shared<auth::Keyring>();
  auth::Key key = test::key_of(auth::Role::kOperator, 160);
  key.signing.reset();
  keys->add(std::move(key));
  Process captured(hub_, clock_, 6, test::authenticator(keys));
  models::OperatorCommand command;
  command.stamp.time = clock_.now();
  command.action = OperatorAction::kEmergencyStop;
  captured.bus.publish(kCommand, command);
  handle_all();
  EXPECT_TRUE(vehicle_.commands.empty());
  EXPECT_EQ(vehicle_.count("COMMAND.unsigned"), 1);
  EXPECT_EQ(captured.count("COMMAND.no_key"), 1);
}

TEST_F(SecuredBus, AcceptsAStationWithAWrongClockIfItEchoesTheNonce) {
  VirtualClock wrong(kStart);
  Process station(hub_, wrong, 8, test::authenticator(keys_));
  publish_status(vehicle_.bus);
  station.handle_all();
  wrong.set(kStart + std::chrono::hours(1));
  models::OperatorCommand command;
  command.stamp.time = clock_.now();
  command.action = OperatorAction::kHeartbeat;
  station.bus.publish(kCommand, command);
  handle_all();
  EXPECT_EQ(vehicle_.commands.size(), 1U);
}

TEST(RefusalCounts, AreParsedFromCounterNames) {
  const auto count = auth::parse_refusal("PLAN_Q1.bad_mac");
  ASSERT_TRUE(count.has_value());
  EXPECT_EQ(count->channel, "PLAN_Q1");
  EXPECT_EQ(count->reason, "bad_mac");
  EXPECT_FALSE(auth::parse_refusal("VICON.fresh").has_value());
  EXPECT_FALSE(auth::parse_refusal("loops").has_value());
}

}  // namespace
}  // namespace vantage::bus
