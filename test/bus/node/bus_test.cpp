#include "bus/node/bus.hpp"

#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "test/bus/convert/message_types.hpp"
#include "test/support/bus_pair.hpp"
#include "test/support/sent_ref.hpp"

namespace vantage::bus {
namespace {

constexpr std::chrono::microseconds kNow{0};

models::OperatorCommand command(std::int64_t utime, std::string robot = "Q1") {
  return {{from_utime(utime), 0, 0}, models::OperatorAction::kHold, std::move(robot)};
}

std::int64_t count_of(const Bus& bus, const std::string& name) {
  for (const models::NamedCount& counter : bus.counters()) {
    if (counter.name == name) {
      return counter.count;
    }
  }
  return 0;
}

/// Two endpoints on one hub: `raw_` sends arbitrary bytes, which `bus_` must handle.
class BusAgainstRawBytes : public ::testing::Test {
 protected:
  void SetUp() override {
    bus_.subscribe<models::OperatorCommand>(
        kCommand, [this](const models::OperatorCommand& c) { commands_.push_back(c); });
  }
  void send(const models::OperatorCommand& c) { send_bytes(test::encoded(c)); }
  void send_bytes(const std::vector<std::uint8_t>& bytes, const std::string& channel = "COMMAND") {
    raw_->publish(channel, bytes);
    bus_.handle(kNow);
  }
  static models::OperatorCommand stamped(std::int64_t run, std::int64_t sequence,
                                         std::int64_t utime) {
    models::OperatorCommand c = command(utime);
    c.stamp.run_id = run;
    c.stamp.sequence = sequence;
    c.action = models::OperatorAction::kArm;
    return c;
  }

  InProcessHub hub_;
  std::unique_ptr<Transport> raw_ = hub_.connect();
  std::unique_ptr<Transport> endpoint_ = hub_.connect();
  Bus bus_{*endpoint_, 42};
  std::vector<models::OperatorCommand> commands_;
};

TEST(Bus, CountsNoLossWhileUnsubscribed) {
  test::BusPair net(42, 43);
  Bus& publisher = net.own;
  Bus& bus = net.other;
  int received = 0;
  const auto subscribe_both = [&] {
    for (int twice = 0; twice < 2; ++twice) {
      bus.subscribe<models::OperatorCommand>(kCommand,
                                             [&](const models::OperatorCommand&) { ++received; });
    }
  };
  const auto publish_times = [&](int times) {
    for (int i = 0; i < times; ++i) {
      publisher.publish(kCommand, command(5));
      bus.handle(kNow);
    }
  };
  bus.subscribe<models::AttackNotice>(kAttack, [](const auto&) {});
  subscribe_both();
  publish_times(3);
  EXPECT_EQ(received, 6);
  bus.unsubscribe(kAttack.name);  // a later subscription reuses its entry
  bus.unsubscribe(kCommand.name);
  publish_times(3);
  EXPECT_EQ(received, 6);
  subscribe_both();
  publish_times(2);
  EXPECT_EQ(received, 10);
  EXPECT_EQ(bus.messages_lost(), 0);
  EXPECT_EQ(count_of(bus, "left.fresh"), 3);
  EXPECT_EQ(count_of(bus, "COMMAND.fresh"), 2);
}

TEST(Bus, StampsRunAndSequencePerChannel) {
  InProcessHub hub;
  const auto endpoint = hub.connect();
  Bus bus(*endpoint, 42);
  EXPECT_EQ(test::sent_ref(bus, kCommand, command(5)), (models::InputRef{"COMMAND", 42, 0}));
  EXPECT_EQ(test::sent_ref(bus, kCommand, command(6)), (models::InputRef{"COMMAND", 42, 1}));
  EXPECT_EQ(test::sent_ref(bus, kAttack, models::AttackNotice{}),
            (models::InputRef{"ATTACK", 42, 0}));
}

TEST(Bus, ReceivesOwnAndOtherMessagesWithUnchangedTime) {
  test::BusPair net(1, 2);
  Bus& sender = net.own;
  Bus& receiver = net.other;
  std::vector<std::int64_t> times;
  const auto note = [&](const models::OperatorCommand& c) {
    times.push_back(to_utime(c.stamp.time));
  };
  sender.subscribe<models::OperatorCommand>(kCommand, note);
  receiver.subscribe<models::OperatorCommand>(kCommand, note);
  sender.publish(kCommand, command(77));
  EXPECT_EQ(sender.handle(kNow) + receiver.handle(kNow), 2);
  EXPECT_EQ(times, (std::vector<std::int64_t>{77, 77}));
}

TEST(Bus, PrefixesPublishedChannelsOnly) {
  InProcessHub hub;
  const auto one = hub.connect();
  const auto two = hub.connect();
  Bus replay(*one, 1, "REPLAY_");
  Bus watcher(*two, 2);
  std::vector<std::string> names;
  watcher.subscribe_named<models::OperatorCommand>(
      {"REPLAY_*"}, [&](const std::string& name, const auto&) { names.push_back(name); });
  int heard_by_replay = 0;
  replay.subscribe<models::OperatorCommand>(kCommand, [&](const auto&) { ++heard_by_replay; });
  EXPECT_EQ(test::sent_ref(replay, kCommand, command(1)).channel, "REPLAY_COMMAND");
  watcher.publish(kCommand, command(2));
  watcher.handle(kNow);
  replay.handle(kNow);
  EXPECT_EQ(names, (std::vector<std::string>{"REPLAY_COMMAND"}));
  EXPECT_EQ(heard_by_replay, 1);
}

TEST(Bus, MonitorsEachChannelOfAPrefixSeparately) {
  InProcessHub hub;
  const auto endpoint = hub.connect();
  Bus bus(*endpoint, 1);
  std::vector<std::string> names;
  bus.subscribe_named<models::RobotMeasurement>(
      measurement_channel("*"),
      [&](const std::string& name, const auto&) { names.push_back(name); });
  bus.publish(measurement_channel("Q1"), {});
  bus.publish(measurement_channel("Q2"), {});
  bus.publish(measurement_channel("Q1"), {});
  bus.handle(kNow);
  EXPECT_EQ(names,
            (std::vector<std::string>{"MEASUREMENT_Q1", "MEASUREMENT_Q2", "MEASUREMENT_Q1"}));
  EXPECT_EQ(count_of(bus, "MEASUREMENT_Q1.fresh"), 2);
  EXPECT_EQ(count_of(bus, "MEASUREMENT_Q2.fresh"), 1);
  EXPECT_EQ(bus.messages_lost(), 0);
}

TEST(Bus, DeliversOncePerOverlappingSubscription) {
  InProcessHub hub;
  const auto endpoint = hub.connect();
  Bus bus(*endpoint, 1);
  std::string order;
  const auto note = [&](char who) {
    return [&order, who](const models::RobotPlan&) { order += who; };
  };
  bus.subscribe<models::RobotPlan>(plan_channel("Q1"), note('a'));
  bus.subscribe<models::RobotPlan>(plan_channel("*"), note('b'));
  bus.subscribe<models::RobotPlan>(plan_channel("Q1"), note('c'));
  models::RobotPlan plan;
  bus.publish(plan_channel("Q1"), plan);
  bus.publish(plan_channel("Q2"), plan);
  bus.handle(kNow);
  EXPECT_EQ(order, "abcb");
  EXPECT_EQ(count_of(bus, "PLAN_Q1.duplicates"), 0);
}

TEST_F(BusAgainstRawBytes, CountsAndDropsUndecodableMessages) {
  send_bytes({1, 2, 3});
  send_bytes(test::encoded(models::AttackNotice{}));
  std::vector<std::uint8_t> truncated = test::encoded(command(1));
  truncated.pop_back();
  send_bytes(truncated);
  EXPECT_TRUE(commands_.empty());
  EXPECT_EQ(count_of(bus_, "COMMAND.decode_errors"), 3);
}

TEST_F(BusAgainstRawBytes, CountsAndDropsInvalidMessages) {
  models::OperatorCommand impossible = command(1);
  impossible.action = static_cast<models::OperatorAction>(99);
  send(impossible);
  EXPECT_TRUE(commands_.empty());
  EXPECT_EQ(count_of(bus_, "COMMAND.refused"), 1);
  EXPECT_EQ(count_of(bus_, "COMMAND.decode_errors"), 0);
}

TEST_F(BusAgainstRawBytes, ReceivesFromAnyNumberOfConsoles) {
  send(stamped(1, 0, 10));
  send(stamped(2, 0, 20));
  send(stamped(1, 1, 15));  // stamped earlier than the other console's message
  send(stamped(2, 1, 25));
  send(stamped(1, 1, 15));
  send(stamped(1, 3, 30));
  ASSERT_EQ(commands_.size(), 5U);
  EXPECT_EQ(to_utime(commands_[4].stamp.time), 30);
  EXPECT_EQ(count_of(bus_, "COMMAND.duplicates"), 1);
  EXPECT_EQ(count_of(bus_, "COMMAND.old_runs"), 0);
  EXPECT_EQ(bus_.messages_lost(), 1);
  // A flood of consoles displaces those that were silent longest; memory stays bounded.
  for (std::int64_t run = 100; run < 1'100; ++run) {
    send(stamped(run, 0, 40));
  }
  EXPECT_EQ(commands_.size(), 1'005U);
  EXPECT_EQ(bus_.messages_lost(), 1);
}

// A safer command is delivered with any sequence number, since a forged number must not suppress a
// stop. The receiver decides whether to obey.
TEST_F(BusAgainstRawBytes, DeliversSaferCommandsWithAnySequenceNumber) {
  using models::OperatorAction;
  send(stamped(1, std::int64_t{1} << 40, 10));
  ASSERT_EQ(commands_.size(), 1U);
  for (const OperatorAction action :
       {OperatorAction::kHold, OperatorAction::kLand, OperatorAction::kEmergencyStop}) {
    for (const std::int64_t sequence : {3, 3, 2, 1}) {
      models::OperatorCommand safer = stamped(1, sequence, 11);
      safer.action = action;
      send(safer);
    }
  }
  EXPECT_EQ(commands_.size(), 13U);
  models::OperatorCommand follow = stamped(1, 4, 9);
  follow.action = OperatorAction::kFollow;
  send(follow);
  EXPECT_EQ(commands_.size(), 13U) << "no other message was received";
}

/// Checks a channel with a single publisher: messages of run 2 are delivered while it publishes,
/// and those of run 3 afterwards.
template <class Message>
void expect_first_is_kept(const Channel<Message>& channel, Message message) {
  InProcessHub hub;
  const auto endpoint = hub.connect();
  const auto first_side = hub.connect();
  const auto second_side = hub.connect();
  Bus bus(*endpoint, 1);
  Bus first(*first_side, 2);
  Bus second(*second_side, 3);
  VirtualClock clock(from_utime(1'700'000'000'000'000));
  bus.use_clock(clock);
  std::vector<std::int64_t> received;
  bus.subscribe<Message>(channel,
                         [&](const Message& each) { received.push_back(each.stamp.run_id); });
  const auto run = [&](double seconds, bool first_speaks) {
    const Time end = clock.now() + from_seconds(seconds);
    for (; clock.now() < end; clock.set(clock.now() + Duration{10'000})) {
      message.stamp.time = clock.now();
      if (first_speaks) {
        first.publish(channel, message);
      }
      second.publish(channel, message);
      bus.handle(kNow);
    }
  };
  run(2.0, true);
  EXPECT_EQ(received, std::vector<std::int64_t>(200, 2));
  received.clear();
  run(2.0, false);
  EXPECT_EQ(received, std::vector<std::int64_t>(151, 3)) << "once the publisher is silent";
}

TEST(Bus, KeepsTheFirstMocapWhileItPublishes) {
  expect_first_is_kept(kVicon, models::MocapFrame{});
}

// A second simulation on the network of a real flight reports that the same robots are on the
// ground.
TEST(Bus, KeepsTheFirstPublisherOfAVehicleWhileItPublishes) {
  models::VehicleStatus status;
  status.robot = "Q1";
  expect_first_is_kept(vehicle_channel("Q1"), status);
}

TEST_F(BusAgainstRawBytes, DropsDuplicatesOvertakenMessagesAndOldRuns) {
  bus_.subscribe<models::OperatorCommand>(
      {"SINGLE"}, [this](const models::OperatorCommand& c) { commands_.push_back(c); });
  const auto send = [this](const models::OperatorCommand& c) {
    send_bytes(test::encoded(c), "SINGLE");
  };
  send(stamped(1, 0, 10));
  send(stamped(1, 2, 12));
  EXPECT_EQ(bus_.messages_lost(), 1);
  send(stamped(1, 2, 12));
  send(stamped(1, 1, 11));
  send(stamped(2, 0, 20));
  send(stamped(1, 3, 30));
  ASSERT_EQ(commands_.size(), 3U);
  EXPECT_EQ(to_utime(commands_[2].stamp.time), 20);
  EXPECT_EQ(bus_.messages_lost(), 0);
  EXPECT_EQ(count_of(bus_, "SINGLE.duplicates"), 1);
  EXPECT_EQ(count_of(bus_, "SINGLE.reordered"), 1);
  EXPECT_EQ(count_of(bus_, "SINGLE.old_runs"), 1);
  EXPECT_EQ(count_of(bus_, "SINGLE.restarts"), 1);
}

TEST_F(BusAgainstRawBytes, SumsTheCountsOfManyStreams) {
  bus_.subscribe<models::RobotPlan>(plan_channel("*"), [](const auto&) {});
  const auto publish_times = [&](int robot, std::int64_t run, std::int64_t sequence) {
    models::RobotPlan plan;
    plan.stamp.time = from_utime(10 * run + sequence);
    plan.stamp.run_id = run;
    plan.stamp.sequence = sequence;
    send_bytes(test::encoded(plan), "PLAN_" + std::to_string(robot));
  };
  for (int robot = 0; robot < 300; ++robot) {
    publish_times(robot, 1, 0);
    publish_times(robot, 1, 3);
    publish_times(robot, 1, 3);
  }
  publish_times(7, 2, 0);
  publish_times(8, 2, 0);
  publish_times(8, 3, 0);
  EXPECT_EQ(count_of(bus_, "PLAN_*.fresh"), 603);
  EXPECT_EQ(count_of(bus_, "PLAN_*.duplicates"), 300);
  EXPECT_EQ(count_of(bus_, "PLAN_*.restarts"), 3);
  EXPECT_EQ(count_of(bus_, "PLAN_7.fresh"), 0) << "streams are only counted by kind";
}

TEST_F(BusAgainstRawBytes, StaysBoundedUnderAFloodOfChannelNames) {
  bus_.subscribe<models::RobotPlan>(plan_channel("*"), [](const auto&) {});
  for (int i = 0; i < 20'000; ++i) {
    send_bytes(test::encoded(models::RobotPlan{}), "PLAN_" + std::to_string(i));
    send_bytes({0}, "PLAN_JUNK" + std::to_string(i));
  }
  EXPECT_EQ(count_of(bus_, "bus.streams_refused"), 20'000 - 16'383);
  send(stamped(1, 0, 10));
  EXPECT_EQ(commands_.size(), 1U) << "this channel was subscribed to by name";
  EXPECT_EQ(count_of(bus_, "(other).decode_errors"), 20'000 - 1'024);
  EXPECT_LT(bus_.counters().size(), 10'000U) << "HEALTH can still contain all counters";
}

TEST_F(BusAgainstRawBytes, IsUsableAfterAHandlerThrew) {
  bool throws = true;
  bus_.subscribe<models::OperatorCommand>(kCommand, [&](const auto&) {
    if (throws) {
      throw std::runtime_error("handler");
    }
  });
  raw_->publish("COMMAND", test::encoded(stamped(1, 0, 1)));
  raw_->publish("COMMAND", test::encoded(stamped(1, 1, 2)));
  EXPECT_THROW(bus_.handle(kNow), std::runtime_error);
  throws = false;
  EXPECT_EQ(bus_.handle(kNow), 1);
  EXPECT_EQ(commands_.size(), 2U);
}

TEST(Bus, MayBeDestroyedBeforeItsTransport) {
  InProcessHub hub;
  const auto endpoint = hub.connect();
  int received = 0;
  {
    Bus bus(*endpoint, 1);
    bus.subscribe<models::OperatorCommand>(kCommand, [&](const auto&) { ++received; });
    bus.publish(kCommand, command(1));
  }
  endpoint->handle(kNow);
  EXPECT_EQ(received, 0);
}

TEST(Bus, LetsHandlersPublishAndSubscribe) {
  InProcessHub hub;
  const auto endpoint = hub.connect();
  Bus bus(*endpoint, 1);
  int attacks = 0;
  bus.subscribe<models::OperatorCommand>(kCommand, [&](const auto&) {
    bus.subscribe<models::AttackNotice>(kAttack, [&](const auto&) { ++attacks; });
    bus.publish(kAttack, models::AttackNotice{});
  });
  bus.publish(kCommand, command(1));
  EXPECT_EQ(bus.handle(kNow), 1);
  EXPECT_EQ(bus.handle(kNow), 1);
  EXPECT_EQ(attacks, 1);
}

TEST(RandomRunId, IsPositiveAndUnique) {
  std::set<std::int64_t> ids;
  for (int i = 0; i < 1'000; ++i) {
    ids.insert(random_run_id());
  }
  EXPECT_EQ(ids.size(), 1'000U);
  EXPECT_GT(*ids.begin(), 0);
}

}  // namespace
}  // namespace vantage::bus
