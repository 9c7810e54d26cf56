#include <gtest/gtest.h>

#include "core/deadline.hpp"
#include "test/integration/network_support.hpp"

// Our udpm transport against liblcm, both ways, on a real network.

namespace vantage {
namespace {

using test::Bytes;
using Heard = std::vector<std::pair<std::string, Bytes>>;

/// Around both limits of a datagram (channel "SIZE_X" takes 7 bytes), and the sizes of lab
/// messages.
const std::vector<std::size_t> kSizes{0,      1,      200,     60'000,  65'480,  65'492,
                                      65'493, 65'499, 130'967, 130'968, 300'000, 2'000'000};

Bytes payload(std::size_t size) { return test::random_bytes(size, static_cast<unsigned>(size)); }

TEST(UdpmInterop, ReachesLiblcmAtEverySize) {
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

TEST(UdpmInterop, HearsLiblcmAtEverySize) {
  if (!test::has_large_buffers()) {
    GTEST_SKIP() << test::kNeedsLargeBuffers;
  }
  const auto ours = bus::open_transport(test::kUrl);
  Heard heard;
  test::collect(*ours, "SIZE_*", heard);
  test::Liblcm theirs("NOTHING");
  std::size_t sent = 0;
  for (const std::size_t size : kSizes) {
    ASSERT_TRUE(theirs.publish("SIZE_X", payload(size)));
    test::handle_until(*ours, [&] { return heard.size() > sent; });
    ASSERT_EQ(heard.size(), ++sent) << size << " bytes";
    EXPECT_TRUE(heard.back().second == payload(size)) << size << " bytes";
  }
  EXPECT_EQ(ours->stats().malformed_datagrams, 0);
  EXPECT_EQ(ours->stats().incomplete_messages, 0);
}

TEST(UdpmInterop, LetsTwoOfOursAndOneOfTheirsShareThePort) {
  const auto first = bus::open_transport(test::kUrl);
  const auto second = bus::open_transport(test::kUrl);
  test::Liblcm theirs("SHARED");
  Heard at_first;
  Heard at_second;
  test::collect(*first, "SHARED", at_first);
  test::collect(*second, "SHARED", at_second);
  first->publish("SHARED", Bytes{1});
  test::handle_until(*first, [&] { return !at_first.empty(); });
  test::handle_until(*second, [&] { return !at_second.empty(); });
  theirs.handle_until(1);
  EXPECT_EQ(at_first.size(), 1U) << "the sender hears itself";
  EXPECT_EQ(at_second.size(), 1U);
  EXPECT_EQ(theirs.heard().size(), 1U);
}

// 1000 × 200 B back to back before anybody handles anything.
TEST(UdpmInterop, LosesNothingOfABurstToUs) {
  if (!test::has_large_buffers()) {
    GTEST_SKIP() << test::kNeedsLargeBuffers;
  }
  constexpr std::size_t kBurst = 1'000;
  const auto ours = bus::open_transport(test::kUrl);
  test::Liblcm theirs("NOTHING");
  Heard heard;
  test::collect(*ours, "BURST", heard);
  for (unsigned i = 0; i < kBurst; ++i) {
    ASSERT_TRUE(theirs.publish("BURST", test::random_bytes(200, i)));
  }
  test::handle_until(*ours, [&] { return heard.size() >= kBurst; });
  ASSERT_EQ(heard.size(), kBurst);
  for (unsigned i = 0; i < kBurst; ++i) {
    ASSERT_EQ(heard[i].second, test::random_bytes(200, i)) << "in order";
  }
  EXPECT_EQ(ours->stats().kernel_drops, 0);
}

TEST(UdpmInterop, LosesNothingOfABurstFromUs) {
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

TEST(UdpmTransport, RefusesAndCountsWhatLcmCannotCarry) {
  const auto ours = bus::open_transport(test::kUrl + "&max_message_size=100000");
  EXPECT_FALSE(ours->publish(std::string(64, 'C'), Bytes{1}));
  EXPECT_FALSE(ours->publish("", Bytes{1}));
  EXPECT_FALSE(ours->publish("X", Bytes(100'001)));
  EXPECT_EQ(ours->stats().send_errors, 3);
  EXPECT_EQ(ours->stats().messages_sent, 0);
}

TEST(UdpmTransport, RefusesAndCountsOversizedMessagesOfOthers) {
  const auto small = bus::open_transport(test::kUrl + "&max_message_size=100000");
  const auto large = bus::open_transport(test::kUrl);
  Heard heard;
  test::collect(*small, "*", heard);
  large->publish("X", Bytes(100'001));
  large->publish("X", Bytes{1});
  test::handle_until(*small, [&] { return !heard.empty(); });
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard[0].second, Bytes{1});
  EXPECT_EQ(small->stats().oversized_messages, 2) << "fragments";
}

TEST(UdpmTransport, WaitsForAsLongAsItIsToldWhereNothingComes) {
  const auto ours = bus::open_transport(test::kUrl);
  const std::int64_t begin_ns = monotonic_ns();
  EXPECT_EQ(ours->handle(std::chrono::milliseconds(20)), 0);
  EXPECT_GE(monotonic_ns() - begin_ns, 20'000'000);
}

TEST(UdpmTransport, BringsAHandlersExceptionOutAndStaysUsable) {
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
