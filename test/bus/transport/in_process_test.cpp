#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "bus/transport/channel_pattern.hpp"
#include "bus/transport/transport.hpp"
#include "core/check.hpp"

namespace vantage::bus {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::chrono::microseconds kNow{0};
constexpr std::chrono::seconds kLong{60};

Transport::Handler into(std::vector<Bytes>& list) {
  return [&list](std::string_view, std::span<const std::uint8_t> bytes) {
    list.emplace_back(bytes.begin(), bytes.end());
  };
}

/// Two endpoints that store the messages that they receive; b receives everything.
struct TwoListeners {
  explicit TwoListeners(const char* of_a) {
    a->subscribe(of_a, into(at_a));
    b->subscribe("*", into(at_b));
  }
  InProcessHub hub;
  std::unique_ptr<Transport> a = hub.connect();
  std::unique_ptr<Transport> b = hub.connect();
  std::vector<Bytes> at_a;
  std::vector<Bytes> at_b;
};

TEST(InProcessHub, DeliversToEveryEndpointIncludingTheSender) {
  TwoListeners two("X");
  auto& [hub, a, b, at_a, at_b] = two;
  EXPECT_TRUE(a->publish("X", Bytes{1}));
  EXPECT_TRUE(b->publish("X", Bytes{2}));
  EXPECT_TRUE(b->publish("Y", Bytes{3}));
  EXPECT_EQ(a->handle(kNow), 2);
  EXPECT_EQ(b->handle(kNow), 3);
  EXPECT_EQ(at_a, (std::vector<Bytes>{{1}, {2}}));
  EXPECT_EQ(at_b, (std::vector<Bytes>{{1}, {2}, {3}}));
}

TEST(InProcessHub, DeliversNothingAfterUnsubscribing) {
  InProcessHub hub;
  const auto a = hub.connect();
  std::vector<Bytes> received;
  for (const char* name : {"X", "P*"}) {
    a->subscribe(name, into(received));
    a->publish("X", Bytes{1});
    a->publish("PQ", Bytes{1});
    a->unsubscribe(name);
    EXPECT_EQ(a->handle(kNow), 1);
    EXPECT_TRUE(received.empty()) << "the message was still in the queue";
    a->publish("X", Bytes{2});
    a->publish("PQ", Bytes{2});
    EXPECT_EQ(a->handle(kNow), 0);
  }
  a->subscribe("X", into(received));
  a->publish("X", Bytes{3});
  a->handle(kNow);
  EXPECT_EQ(received, (std::vector<Bytes>{{3}}));
}

TEST(InProcessHub, DropsAndCountsTheOldestMessage) {
  InProcessHub hub(3);
  const auto slow = hub.connect();
  const auto fast = hub.connect();
  std::vector<Bytes> received;
  slow->subscribe("X", into(received));
  for (std::uint8_t i = 0; i < 5; ++i) {
    fast->publish("X", Bytes{i});
  }
  EXPECT_EQ(slow->handle(kNow), 3);
  EXPECT_EQ(received, (std::vector<Bytes>{{2}, {3}, {4}}));
  EXPECT_EQ(slow->stats().queue_overflows, 2);
  EXPECT_EQ(slow->stats().messages_received, 3);
  EXPECT_EQ(fast->stats().messages_sent, 5);
  EXPECT_EQ(fast->stats().queue_overflows, 0) << "each endpoint has its own queue";
}

TEST(InProcessHub, QueuesMessagesOfHandlersForTheNextHandle) {
  InProcessHub hub;
  const auto endpoint = hub.connect();
  int calls = 0;
  endpoint->subscribe("X", [&](auto, auto) {
    ++calls;
    endpoint->publish("X", Bytes{});
  });
  endpoint->publish("X", Bytes{});
  EXPECT_EQ(endpoint->handle(kNow), 1);
  EXPECT_EQ(endpoint->handle(kNow), 1);
  EXPECT_EQ(calls, 2);
}

TEST(InProcessHub, KeepsTheQueueWhenAHandlerThrows) {
  InProcessHub hub;
  const auto endpoint = hub.connect();
  std::vector<Bytes> received;
  endpoint->subscribe("X", [&](std::string_view, std::span<const std::uint8_t> bytes) {
    if (bytes[0] == 0) {
      throw std::runtime_error("handler");
    }
    received.emplace_back(bytes.begin(), bytes.end());
  });
  endpoint->publish("X", Bytes{0});
  endpoint->publish("X", Bytes{1});
  EXPECT_THROW(endpoint->handle(kNow), std::runtime_error);
  EXPECT_EQ(endpoint->handle(kNow), 1);
  EXPECT_EQ(received, (std::vector<Bytes>{{1}}));
}

TEST(InProcessHub, ForgetsDestroyedEndpoints) {
  InProcessHub hub;
  const auto stays = hub.connect();
  { const auto goes = hub.connect(); }
  EXPECT_TRUE(stays->publish("X", Bytes{1}));
}

// New endpoints reuse the memory of destroyed ones; they receive only what they subscribed to,
// once.
TEST(InProcessHub, DeliversNothingToDestroyedEndpoints) {
  for (const char* const pattern : {"X", "X*"}) {
    InProcessHub hub;
    const auto publisher = hub.connect();
    std::vector<Bytes> ignored;
    int arrivals = 0;
    auto goes = hub.connect([&arrivals] { ++arrivals; });
    goes->subscribe(pattern, into(ignored));
    publisher->publish("X", Bytes{1});
    EXPECT_EQ(arrivals, 1);
    goes.reset();
    std::vector<std::unique_ptr<Transport>> next;
    for (int i = 0; i < 8; ++i) {
      next.push_back(hub.connect([&arrivals] { ++arrivals; }));
    }
    publisher->publish("X", Bytes{2});
    EXPECT_EQ(arrivals, 1) << "the endpoints have not subscribed yet";
    for (const auto& each : next) {
      each->subscribe(pattern, into(ignored));
    }
    publisher->publish("X", Bytes{3});
    EXPECT_EQ(arrivals, 1 + 8);
    for (const auto& each : next) {
      EXPECT_EQ(each->handle(kNow), 1);
    }
  }
}

TEST(InProcessHub, DeliversOncePerHandlerOfAnEndpoint) {
  InProcessHub hub;
  const auto endpoint = hub.connect();
  std::string order;
  const std::vector<std::pair<const char*, char>> handlers{
      {"XY", 'a'}, {"X*", 'b'}, {"*", 'c'}, {"XY", 'd'}, {"Z", 'e'}};
  for (const auto& [pattern, who] : handlers) {
    endpoint->subscribe(pattern, [&order, who = who](auto, auto) { order += who; });
  }
  endpoint->publish("XY", Bytes{1});
  endpoint->publish("XZ", Bytes{1});
  EXPECT_EQ(endpoint->handle(kNow), 2) << "a message counts once for any number of handlers";
  EXPECT_EQ(order, "abcdbc");
  EXPECT_EQ(endpoint->stats().messages_received, 2);
  EXPECT_EQ(endpoint->stats().messages_sent, 2);
  order.clear();
  endpoint->unsubscribe("X*");
  endpoint->publish("XZ", Bytes{1});
  EXPECT_EQ(endpoint->handle(kNow), 1) << "the other pattern still matches";
  endpoint->unsubscribe("*");
  endpoint->unsubscribe("*");
  endpoint->publish("XZ", Bytes{1});
  EXPECT_EQ(endpoint->handle(kNow), 0);
  endpoint->publish("XY", Bytes{1});
  EXPECT_EQ(endpoint->handle(kNow), 1) << "the name still matches";
  EXPECT_EQ(order, "cad");
  endpoint->unsubscribe("XY");
  endpoint->publish("XY", Bytes{1});
  EXPECT_EQ(endpoint->handle(kNow), 0);
}

TEST(Decoded, HoldsTheLastStoredValueOfOneType) {
  Decoded decoded;
  EXPECT_EQ(decoded.get<int>(), nullptr);
  decoded.keep(std::make_shared<const int>(5));
  ASSERT_NE(decoded.get<int>(), nullptr);
  EXPECT_EQ(*decoded.get<int>(), 5);
  EXPECT_EQ(decoded.get<unsigned>(), nullptr);
  decoded.keep(std::make_shared<const unsigned>(6U));
  EXPECT_EQ(decoded.get<int>(), nullptr);
  EXPECT_EQ(*decoded.get<unsigned>(), 6U);
}

// The decoded form of a message is shared by all its receivers and never used for another message.
TEST(InProcessHub, SharesADecodedMessage) {
  InProcessHub hub;
  const auto a = hub.connect();
  const auto b = hub.connect();
  std::vector<int> found;
  const auto note = [&found](std::string_view, const Payload& payload) {
    ASSERT_NE(payload.decoded, nullptr);
    const auto known = payload.decoded->get<int>();
    found.push_back(known ? *known : 0);
    payload.decoded->keep(std::make_shared<const int>(payload[0]));
  };
  a->subscribe("X", note);
  b->subscribe("X", note);
  a->publish("X", Bytes{7});
  a->publish("X", Bytes{8});
  a->handle(kNow);
  b->handle(kNow);
  EXPECT_EQ(found, (std::vector<int>{0, 0, 7, 8}));
}

TEST(InProcessHub, RefusesAnEmptyQueue) { EXPECT_THROW(InProcessHub(0), UsageError); }

// Two senders in separate threads; both receivers must receive all messages in the same order.
TEST(InProcessHub, DeliversConcurrentMessagesInOneOrder) {
  constexpr int kEach = 2'000;
  TwoListeners two("*");
  auto& [hub, a, b, at_a, at_b] = two;
  const auto send = [&hub = two.hub](std::uint8_t who) {
    const auto endpoint = hub.connect();
    for (int i = 0; i < kEach; ++i) {
      endpoint->publish("X", Bytes{who, static_cast<std::uint8_t>(i)});
    }
  };
  std::thread first(send, std::uint8_t{1});
  std::thread second(send, std::uint8_t{2});
  while (at_a.size() < 2 * kEach && a->handle(kLong) > 0) {
  }
  first.join();
  second.join();
  while (at_b.size() < 2 * kEach && b->handle(kLong) > 0) {
  }
  EXPECT_EQ(at_a.size(), 2U * kEach);
  EXPECT_EQ(at_a, at_b);
}

TEST(ChannelMatches, SupportsNamesAndPrefixes) {
  EXPECT_TRUE(channel_matches("PLAN_Q1", "PLAN_Q1"));
  EXPECT_FALSE(channel_matches("PLAN_Q1", "PLAN_Q12"));
  EXPECT_FALSE(channel_matches("PLAN_Q12", "PLAN_Q1"));
  EXPECT_TRUE(channel_matches("PLAN_*", "PLAN_Q1"));
  EXPECT_TRUE(channel_matches("PLAN_*", "PLAN_"));
  EXPECT_FALSE(channel_matches("PLAN_*", "PLAN"));
  EXPECT_TRUE(channel_matches("*", "ANYTHING"));
  EXPECT_FALSE(channel_matches("P.AN", "PLAN")) << "regular expressions are not supported";
}

}  // namespace
}  // namespace vantage::bus
