#include <gtest/gtest.h>

#include "core/check.hpp"
#include "core/deadline.hpp"
#include "test/integration/network_support.hpp"

// Compares our udpm transport with liblcm, in both directions, on a real network.

namespace vantage {
namespace {

using test::Bytes;
using Messages = std::vector<std::pair<std::string, Bytes>>;

/// Sizes around both limits of a datagram (channel "SIZE_X" takes 7 bytes), and sizes of lab
/// messages.
const std::vector<std::size_t> kSizes{0,      1,      200,     60'000,  65'480,  65'492,
                                      65'493, 65'499, 130'967, 130'968, 300'000, 2'000'000};

Bytes payload(std::size_t size) { return test::random_bytes(size, static_cast<unsigned>(size)); }

TEST(UdpmInterop, LiblcmReceivesMessagesOfEverySize) {
  if (!test::has_large_buffers()) {
    GTEST_SKIP() << test::kNeedsLargeBuffers;
  }
  test::Liblcm theirs("SIZE_.*");
  const auto ours = bus::open_transport(test::kUrl);
  std::size_t sent = 0;
  for (const std::size_t size : kSizes) {
    ASSERT_TRUE(ours->publish("SIZE_X", payload(size)));
    theirs.handle_until(++sent);
    ASSERT_EQ(theirs.heard().size(), sent) << size << " bytes";
    EXPECT_EQ(theirs.heard().back().first, "SIZE_X");
    EXPECT_TRUE(theirs.heard().back().second == payload(size)) << size << " bytes";
  }
}

TEST(UdpmInterop, ReceivesMessagesOfEverySizeFromLiblcm) {
  if (!test::has_large_buffers()) {
    GTEST_SKIP() << test::kNeedsLargeBuffers;
  }
  const auto ours = bus::open_transport(test::kUrl);
  Messages received;
  test::collect(*ours, "SIZE_*", received);
  test::Liblcm theirs("NOTHING");
  std::size_t sent = 0;
  for (const std::size_t size : kSizes) {
    ASSERT_TRUE(theirs.publish("SIZE_X", payload(size)));
    test::handle_until(*ours, [&] { return received.size() > sent; });
    ASSERT_EQ(received.size(), ++sent) << size << " bytes";
    EXPECT_TRUE(received.back().second == payload(size)) << size << " bytes";
  }
  EXPECT_EQ(ours->stats().malformed_datagrams, 0);
  EXPECT_EQ(ours->stats().incomplete_messages, 0);
}

TEST(UdpmInterop, SharesThePortWithLiblcm) {
  const auto first = bus::open_transport(test::kUrl);
  const auto second = bus::open_transport(test::kUrl);
  test::Liblcm theirs("SHARED");
  Messages at_first;
  Messages at_second;
  test::collect(*first, "SHARED", at_first);
  test::collect(*second, "SHARED", at_second);
  first->publish("SHARED", Bytes{1});
  test::handle_until(*first, [&] { return !at_first.empty(); });
  test::handle_until(*second, [&] { return !at_second.empty(); });
  theirs.handle_until(1);
  EXPECT_EQ(at_first.size(), 1U) << "the sender receives its own message";
  EXPECT_EQ(at_second.size(), 1U);
  EXPECT_EQ(theirs.heard().size(), 1U);
}

// 1000 messages of 200 B are sent back to back before the receiver handles the first one.
TEST(UdpmInterop, ReceivesABurstWithoutLoss) {
  if (!test::has_large_buffers()) {
    GTEST_SKIP() << test::kNeedsLargeBuffers;
  }
  constexpr std::size_t kBurst = 1'000;
  const auto ours = bus::open_transport(test::kUrl);
  test::Liblcm theirs("NOTHING");
  Messages received;
  test::collect(*ours, "BURST", received);
  for (unsigned i = 0; i < kBurst; ++i) {
    ASSERT_TRUE(theirs.publish("BURST", test::random_bytes(200, i)));
  }
  test::handle_until(*ours, [&] { return received.size() >= kBurst; });
  ASSERT_EQ(received.size(), kBurst);
  for (unsigned i = 0; i < kBurst; ++i) {
    ASSERT_EQ(received[i].second, test::random_bytes(200, i)) << "in order";
  }
  EXPECT_EQ(ours->stats().kernel_drops, 0);
}

TEST(UdpmInterop, SendsABurstWithoutLoss) {
  if (!test::has_large_buffers()) {
    GTEST_SKIP() << test::kNeedsLargeBuffers;
  }
  constexpr std::size_t kBurst = 1'000;
  test::Liblcm theirs("BURST");
  const auto ours = bus::open_transport(test::kUrl);
  for (unsigned i = 0; i < kBurst; ++i) {
    ASSERT_TRUE(ours->publish("BURST", test::random_bytes(200, i)));
  }
  theirs.handle_until(kBurst);
  ASSERT_EQ(theirs.heard().size(), kBurst);
  for (unsigned i = 0; i < kBurst; ++i) {
    ASSERT_EQ(theirs.heard()[i].second, test::random_bytes(200, i)) << "in order";
  }
}

TEST(UdpmTransport, RefusesAndCountsMessagesBeyondLcmsLimits) {
  const auto ours = bus::open_transport(test::kUrl + "&max_message_size=100000");
  EXPECT_FALSE(ours->publish(std::string(64, 'C'), Bytes{1}));
  EXPECT_FALSE(ours->publish("", Bytes{1}));
  EXPECT_FALSE(ours->publish("X", Bytes(100'001)));
  EXPECT_EQ(ours->stats().send_errors, 3);
  EXPECT_EQ(ours->stats().messages_sent, 0);
}

TEST(UdpmTransport, RefusesAndCountsReceivedOversizedMessages) {
  const auto small = bus::open_transport(test::kUrl + "&max_message_size=100000");
  const auto large = bus::open_transport(test::kUrl);
  Messages received;
  test::collect(*small, "*", received);
  large->publish("X", Bytes(100'001));
  large->publish("X", Bytes{1});
  test::handle_until(*small, [&] { return !received.empty(); });
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].second, Bytes{1});
  EXPECT_EQ(small->stats().oversized_messages, 1) << "one message of two fragments";
}

TEST(UdpmTransport, TransmitsTheLargestMessage) {
  const auto ours = bus::open_transport(test::kUrl + "&max_message_size=100000");
  Messages received;
  test::collect(*ours, "X", received);
  EXPECT_TRUE(ours->publish("X", payload(100'000)));
  EXPECT_FALSE(ours->publish("X", payload(100'001)));
  EXPECT_TRUE(ours->publish("X", Bytes{1}));
  test::handle_until(*ours, [&] { return received.size() == 2; });
  ASSERT_EQ(received.size(), 2U);
  EXPECT_TRUE(received[0].second == payload(100'000));
  EXPECT_EQ(ours->stats().messages_sent, 2);
  EXPECT_EQ(ours->stats().messages_received, 2);
  EXPECT_EQ(ours->stats().send_errors, 1);
  EXPECT_EQ(ours->stats().malformed_datagrams, 0);
}

TEST(UdpmTransport, StopsDeliveryAfterUnsubscribe) {
  const auto ours = bus::open_transport(test::kUrl);
  std::string order;
  const auto note = [&order](char who) { return [&order, who](auto, auto) { order += who; }; };
  ours->subscribe("X", note('a'));
  ours->subscribe("X*", note('b'));
  ours->subscribe("Y", note('c'));
  ours->subscribe("X", note('d'));
  const auto receivers_of = [&](const char* channel) {
    order.clear();
    ours->publish(channel, Bytes{1});
    ours->publish("Y", Bytes{1});
    test::handle_until(*ours, [&] { return !order.empty() && order.back() == 'c'; });
    return order;
  };
  EXPECT_EQ(receivers_of("X"), "abdc");
  ours->unsubscribe("X");
  EXPECT_EQ(receivers_of("X"), "bc");
  ours->subscribe("X", note('e'));  // takes the position of the removed handler
  EXPECT_EQ(receivers_of("X"), "ebc");
  ours->unsubscribe("X*");
  EXPECT_EQ(receivers_of("X"), "ec");
  EXPECT_EQ(receivers_of("XY"), "c");
}

// The source of a message identifies the sender's address and port. All messages of one socket have
// the same source; the sources of two sockets on one host differ in the port only.
TEST(UdpmTransport, IdentifiesSender) {
  const auto first = bus::open_transport(test::kUrl);
  const auto second = bus::open_transport(test::kUrl);
  std::vector<std::uint64_t> sources;
  first->subscribe(
      "X", [&](std::string_view, const bus::Payload& bytes) { sources.push_back(bytes.source); });
  for (const auto& sender : {first.get(), second.get()}) {
    for (const std::size_t size : {1U, 100'000U}) {
      const std::size_t before = sources.size();
      ASSERT_TRUE(sender->publish("X", payload(size)));
      test::handle_until(*first, [&] { return sources.size() > before; });
      ASSERT_EQ(sources.size(), before + 1);
    }
  }
  EXPECT_EQ(sources[0], sources[1]);
  EXPECT_EQ(sources[2], sources[3]);
  EXPECT_NE(sources[0], sources[2]);
  EXPECT_EQ(sources[0] >> 16U, sources[2] >> 16U) << "one host";
  EXPECT_NE(sources[0] & 0xFFFFU, 0U);
}

TEST(UdpmTransport, RefusesACallOfHandleInsideAHandler) {
  const auto ours = bus::open_transport(test::kUrl);
  int calls = 0;
  ours->subscribe("X", [&](auto, auto) {
    if (++calls == 1) {
      ours->handle(std::chrono::microseconds{0});
    }
  });
  ours->publish("X", Bytes{1});
  EXPECT_THROW(ours->handle(test::kPatience), UsageError);
  ours->publish("X", Bytes{1});
  test::handle_until(*ours, [&] { return calls == 2; });
  EXPECT_EQ(calls, 2);
}

TEST(UdpmTransport, WaitsForTheTimeoutWithoutMessages) {
  const auto ours = bus::open_transport(test::kUrl);
  const std::int64_t begin_ns = monotonic_ns();
  EXPECT_EQ(ours->handle(std::chrono::milliseconds(20)), 0);
  EXPECT_GE(monotonic_ns() - begin_ns, 20'000'000);
}

TEST(UdpmTransport, RethrowsAHandlersExceptionAndStaysUsable) {
  const auto ours = bus::open_transport(test::kUrl);
  int calls = 0;
  ours->subscribe("X", [&](auto, auto) {
    if (++calls == 1) {
      throw std::runtime_error("handler");
    }
  });
  ours->publish("X", Bytes{1});
  ours->publish("X", Bytes{2});
  EXPECT_THROW(ours->handle(test::kPatience), std::runtime_error);
  test::handle_until(*ours, [&] { return calls == 2; });
  EXPECT_EQ(calls, 2);
}

}  // namespace
}  // namespace vantage
