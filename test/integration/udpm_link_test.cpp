#include <cstdlib>

#include <gtest/gtest.h>

#include "core/deadline.hpp"
#include "test/integration/network_support.hpp"

// What the kernel refuses, drops and takes away is seen and counted.

namespace vantage {
namespace {

using test::Bytes;
using Heard = std::vector<std::pair<std::string, Bytes>>;

TEST(UdpmLink, CountsEveryDatagramTheSocketHadNoRoomFor) {
  constexpr int kSent = 2'000;
  const auto sender = bus::open_transport(test::kUrl);
  const auto receiver = bus::open_transport("udpm://239.255.76.67:7667?ttl=0&recv_buf_size=65536");
  Heard heard;
  test::collect(*receiver, "X", heard);
  // The kernel tells of all drops since the beginning, with the next datagram that it lets in.
  std::int64_t dropped = 0;
  for (int burst = 1; burst <= 3; ++burst) {
    for (int i = 0; i < kSent; ++i) {
      ASSERT_TRUE(sender->publish("X", Bytes(1'000)));
    }
    while (receiver->handle(std::chrono::microseconds{0}) > 0) {
    }
    sender->publish("X", Bytes{1});
    test::handle_until(*receiver, [&] { return heard.back().second.size() == 1; });
    EXPECT_GT(receiver->stats().kernel_drops, dropped);
    dropped = receiver->stats().kernel_drops;
    EXPECT_EQ(static_cast<std::int64_t>(heard.size()) + dropped, burst * (kSent + 1)) << burst;
  }
}

// A flood on a channel that is heard leaves the caller its own work: a handler that takes a
// millisecond is not called as often as there are messages.
TEST(UdpmLink, GivesControlBackWhileAFloodGoesOn) {
  constexpr int kSent = 200;
  const auto sender = bus::open_transport(test::kUrl);
  const auto receiver = bus::open_transport(test::kUrl);
  int heard = 0;
  receiver->subscribe("X", [&heard](std::string_view, std::span<const std::uint8_t>) {
    ++heard;
    const std::int64_t until_ns = monotonic_ns() + 1'000'000;
    while (monotonic_ns() < until_ns) {
    }
  });
  for (int i = 0; i < kSent; ++i) {
    ASSERT_TRUE(sender->publish("X", Bytes(100)));
  }
  const int first = receiver->handle(std::chrono::microseconds{0});
  EXPECT_GT(first, 0);
  EXPECT_LE(first, 6) << "5 ms beyond what the caller gave it";
  while (receiver->handle(std::chrono::microseconds{0}) > 0) {
  }
  EXPECT_EQ(heard + receiver->stats().kernel_drops, kSent) << "the rest waits, nothing is lost";
}

TEST(UdpmLink, SaysHowMuchOfTheReceiveBufferWasNotGranted) {
  constexpr std::int64_t kAsked = 1 << 30;
  const auto greedy = bus::open_transport("udpm://?recv_buf_size=1073741824");
  const bus::TransportStats stats = greedy->stats();
  EXPECT_GT(stats.receive_buffer_bytes, 0);
  EXPECT_EQ(stats.receive_buffer_bytes + stats.receive_buffer_short_bytes, kAsked);
  EXPECT_GT(stats.receive_buffer_short_bytes, 0) << "nobody is granted 1 GiB";
  const auto modest = bus::open_transport("udpm://?recv_buf_size=65536");
  EXPECT_EQ(modest->stats().receive_buffer_short_bytes, 0);
}

TEST(UdpmLink, CountsWhatCannotBeSentAndHealsWithTheInterface) {
  const auto ours = bus::open_transport(test::kUrl);
  Heard heard;
  test::collect(*ours, "X", heard);
  ASSERT_EQ(std::system("ip link set lo down"), 0);
  EXPECT_FALSE(ours->publish("X", Bytes{1}));
  EXPECT_EQ(ours->stats().send_errors, 1);
  ASSERT_EQ(std::system("ip link set lo up && ip route add 224.0.0.0/4 dev lo"), 0);
  EXPECT_TRUE(ours->publish("X", Bytes{2}));
  test::handle_until(*ours, [&] { return !heard.empty(); });
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard[0].second, Bytes{2});
}

}  // namespace
}  // namespace vantage
