#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/node/bus.hpp"
#include "core/deadline.hpp"
#include "test/bus/convert/message_types.hpp"
#include "test/support/bus_pair.hpp"

// Tests the counters of received and missed messages of a process.

namespace vantage::bus {
namespace {

constexpr std::chrono::microseconds kNow{0};

std::map<std::string, std::int64_t> counters_of(const Bus& bus) {
  std::map<std::string, std::int64_t> out;
  for (const models::NamedCount& counter : bus.counters()) {
    EXPECT_NE(counter.count, 0) << counter.name;
    EXPECT_TRUE(out.emplace(counter.name, counter.count).second) << counter.name;
  }
  return out;
}

/// A transport that receives nothing and reports the given statistics.
struct StatedTransport : Transport {
  void subscribe(const std::string& /*channel*/, Handler /*handler*/) override {}
  void unsubscribe(const std::string& /*channel*/) override {}
  bool publish(const std::string& /*channel*/, std::span<const std::uint8_t> /*bytes*/) override {
    return true;
  }
  int handle(std::chrono::microseconds /*timeout*/) override { return 0; }
  [[nodiscard]] TransportStats stats() const override { return stated; }
  TransportStats stated;
};

TEST(BusCounters, NameEachTransportCounter) {
  StatedTransport transport;
  TransportStats& stats = transport.stated;
  stats.messages_sent = 1;
  stats.messages_received = 2;
  stats.send_errors = 3;
  stats.malformed_datagrams = 4;
  stats.incomplete_messages = 5;
  stats.queue_overflows = 6;
  stats.oversized_messages = 7;
  stats.duplicate_fragments = 8;
  stats.kernel_drops = 9;
  stats.receive_buffer_bytes = 10;  // a size; not an error counter
  stats.receive_buffer_short_bytes = 11;
  const Bus bus(transport, 1);
  EXPECT_EQ(counters_of(bus),
            (std::map<std::string, std::int64_t>{{"transport.messages_sent", 1},
                                                 {"transport.messages_received", 2},
                                                 {"transport.send_errors", 3},
                                                 {"transport.malformed_datagrams", 4},
                                                 {"transport.incomplete_messages", 5},
                                                 {"transport.queue_overflows", 6},
                                                 {"transport.oversized_messages", 7},
                                                 {"transport.duplicate_fragments", 8},
                                                 {"transport.kernel_drops", 9},
                                                 {"transport.receive_buffer_short_bytes", 11}}));
  stats = {};
  EXPECT_TRUE(bus.counters().empty()) << "counters of 0 are not reported";
}

/// A bus that receives the plans that `send_plan` publishes.
class BusStreamCounters : public ::testing::Test {
 protected:
  void send_plan(const std::string& channel, std::int64_t run, std::int64_t sequence, int utime) {
    models::RobotPlan plan;
    plan.stamp = {from_utime(utime), run, sequence};
    raw_->publish(channel, test::encoded(plan));
    bus_.handle(kNow);
  }
  /// Publishes seven messages with every possible outcome; three of them are fresh.
  void send_all_kinds(const std::string& channel) {
    send_plan(channel, 1, 0, 10);
    send_plan(channel, 1, 5, 10);       // numbers 1 to 4 are missing
    send_plan(channel, 1, 3, 10);       // reordered: three remain missing
    send_plan(channel, 1, 5, 10);       // a duplicate
    send_plan(channel, 1, 50'000, 10);  // too far ahead
    send_plan(channel, 2, 0, 20);       // a new run
    send_plan(channel, 1, 6, 30);       // an old run: refused
  }
  [[nodiscard]] std::vector<std::int64_t> of(const std::string& stream) const {
    const auto counters = counters_of(bus_);
    std::vector<std::int64_t> out;
    for (const char* const what : {".fresh", ".lost", ".duplicates", ".reordered", ".old_runs",
                                   ".too_far_ahead", ".restarts"}) {
      const auto found = counters.find(stream + what);
      out.push_back(found == counters.end() ? 0 : found->second);
    }
    return out;
  }

  InProcessHub hub_;
  std::unique_ptr<Transport> raw_ = hub_.connect();
  std::unique_ptr<Transport> endpoint_ = hub_.connect();
  Bus bus_{*endpoint_, 42};
  using Counts = std::vector<std::int64_t>;
};

TEST_F(BusStreamCounters, AreReportedPerStream) {
  bus_.subscribe<models::RobotPlan>(plan_channel("*"), [](const auto&) {});
  send_all_kinds("PLAN_A");
  send_plan("PLAN_B", 1, 0, 10);
  EXPECT_EQ(of("PLAN_A"), (Counts{3, 3, 1, 1, 1, 1, 1}));
  EXPECT_EQ(of("PLAN_B"), (Counts{1, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(bus_.messages_lost(), 3);
  EXPECT_EQ(counters_of(bus_)["transport.messages_received"], 8);
}

TEST_F(BusStreamCounters, AreSummedByKindBeyond256Streams) {
  bus_.subscribe<models::RobotPlan>({"*"}, [](const auto&) {});
  send_all_kinds("PLAN_A");
  send_all_kinds("PLAN_B");
  send_all_kinds("MY_PLAN_A");
  for (int i = 0; i < 252; ++i) {
    send_plan("OTHER_" + std::to_string(i), 1, 0, 10);
  }
  send_plan("ALONE", 1, 0, 10);
  EXPECT_EQ(of("PLAN_A"), (Counts{3, 3, 1, 1, 1, 1, 1})) << "256 streams in total";
  EXPECT_EQ(of("PLAN_*"), (Counts{0, 0, 0, 0, 0, 0, 0}));
  send_plan("OTHER_252", 1, 0, 10);
  EXPECT_EQ(of("PLAN_A"), (Counts{0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(of("PLAN_*"), (Counts{6, 6, 2, 2, 2, 2, 2}));
  EXPECT_EQ(of("MY_PLAN_*"), (Counts{3, 3, 1, 1, 1, 1, 1}));
  EXPECT_EQ(of("OTHER_*"), (Counts{253, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(of("ALONE"), (Counts{1, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(bus_.messages_lost(), 9);
}

// Losses counted while subscribed remain in the counters after unsubscribing, for every kind of
// channel.
TEST_F(BusStreamCounters, KeepTheTotalsOfAnUnsubscribedStream) {
  const Channel<models::RobotPlan> shared{"SHARED", true};
  for (int time = 0; time < 2; ++time) {
    bus_.subscribe<models::RobotPlan>(plan_channel("A"), [](const auto&) {});
    bus_.subscribe<models::RobotPlan>(shared, [](const auto&) {});
    send_all_kinds("PLAN_A");
    send_plan("SHARED", 1, 0, 10);
    send_plan("SHARED", 1, 2, 10);
    EXPECT_EQ(of("PLAN_A"), (Counts{3, 3, 1, 1, 1, 1, 1}));
    EXPECT_EQ(of("SHARED"), (Counts{2, 1, 0, 0, 0, 0, 0}));
    bus_.unsubscribe("PLAN_A");
    bus_.unsubscribe("SHARED");
    EXPECT_EQ(of("PLAN_A"), (Counts{0, 0, 0, 0, 0, 0, 0}));
    EXPECT_EQ(of("SHARED"), (Counts{0, 0, 0, 0, 0, 0, 0}));
  }
  EXPECT_EQ(of("left"), (Counts{10, 8, 2, 2, 2, 2, 0}));
  EXPECT_EQ(bus_.messages_lost(), 8);
}

TEST_F(BusStreamCounters, ContinueWhileAnotherSubscriptionMatches) {
  int received = 0;
  bus_.subscribe<models::RobotPlan>(plan_channel("*"), [&](const auto&) { ++received; });
  bus_.subscribe<models::RobotPlan>(plan_channel("A"), [&](const auto&) { ++received; });
  send_plan("PLAN_A", 1, 0, 10);
  EXPECT_EQ(received, 2);
  bus_.unsubscribe("PLAN_A");
  send_plan("PLAN_A", 1, 2, 10);
  EXPECT_EQ(received, 3);
  EXPECT_EQ(of("PLAN_A"), (Counts{2, 1, 0, 0, 0, 0, 0}));
  EXPECT_EQ(of("left"), (Counts{0, 0, 0, 0, 0, 0, 0}));
}

// A malformed message is counted once, for any number of matching subscriptions.
TEST_F(BusStreamCounters, CountAnUndecodableMessageOnce) {
  for (int i = 0; i < 3; ++i) {
    bus_.subscribe<models::RobotPlan>(plan_channel("A"), [](const auto&) {});
  }
  bus_.subscribe<models::RobotPlan>(plan_channel("*"), [](const auto&) {});
  for (int i = 0; i < 2; ++i) {
    raw_->publish("PLAN_A", std::vector<std::uint8_t>{1, 2, 3});
  }
  models::RobotPlan impossible;
  impossible.step_s = -1.0;
  raw_->publish("PLAN_A", test::encoded(impossible));
  bus_.handle(kNow);
  EXPECT_EQ(bus_.undecoded(), 2) << "the third message has a known type";
  EXPECT_EQ(counters_of(bus_)["PLAN_A.decode_errors"], 2);
  EXPECT_EQ(counters_of(bus_)["PLAN_A.refused"], 1);
}

TEST(BusCounters, CountUndecodableMessagesOf1024Channels) {
  InProcessHub hub;
  const auto raw = hub.connect();
  const auto endpoint = hub.connect();
  Bus bus(*endpoint, 1);
  bus.subscribe<models::RobotPlan>({"*"}, [](const auto&) {});
  const auto spoil = [&](int channel) {
    raw->publish("C" + std::to_string(channel), std::vector<std::uint8_t>{0});
    bus.handle(kNow);
  };
  for (int i = 0; i < 1024; ++i) {
    spoil(i);
  }
  EXPECT_EQ(counters_of(bus).count("(other).decode_errors"), 0U);
  spoil(1024);
  spoil(7);
  EXPECT_EQ(counters_of(bus)["(other).decode_errors"], 1);
  EXPECT_EQ(counters_of(bus)["C7.decode_errors"], 2) << "known streams are still counted";
}

// The result is at least the time measured inside the handlers, and less than the total time.
TEST(BusHandling, MeasuresTheTimeInHandlers) {
  test::BusPair net(1, 2);
  std::int64_t inside_ns = 0;
  net.own.subscribe<models::RobotPlan>(plan_channel("Q1"), [&](const auto&) {
    const std::int64_t start_ns = monotonic_ns();
    while (monotonic_ns() < start_ns + 300'000) {
    }
    inside_ns += monotonic_ns() - start_ns;
  });
  EXPECT_EQ(net.own.handling_s(), 0.0);
  const std::int64_t start_ns = monotonic_ns();
  for (int i = 0; i < 3; ++i) {
    net.other.publish(plan_channel("Q1"), {});
    net.own.handle(kNow);
  }
  const double all_s = static_cast<double>(monotonic_ns() - start_ns) * 1e-9;
  EXPECT_GE(net.own.handling_s(), static_cast<double>(inside_ns) * 1e-9);
  EXPECT_LE(net.own.handling_s(), all_s);
}

TEST(BusSecurity, IsOffByDefault) {
  test::BusPair net(1, 2);
  EXPECT_FALSE(net.own.renew_session());
  EXPECT_FALSE(net.own.receives_signed());
  net.own.act_as_vehicle("Q1");
  int received = 0;
  net.own.subscribe<models::OperatorCommand>(kCommand, [&](const auto&) { ++received; });
  net.other.publish(kCommand, {{}, models::OperatorAction::kArm, "Q2"});
  net.own.handle(kNow);
  EXPECT_EQ(received, 1) << "a bus without this check delivers every message";
  EXPECT_FALSE(net.own.receives_signed());
}

}  // namespace
}  // namespace vantage::bus
