#include <cstdlib>
#include <cstring>

#include <gtest/gtest.h>

#include "bus/transport/channel_filter.hpp"
#include "bus/transport/udpm_packet.hpp"
#include "bus/transport/udpm_socket.hpp"
#include "core/check.hpp"
#include "core/deadline.hpp"
#include "test/integration/network_support.hpp"

// Errors and drops of the kernel, and lost interfaces, are detected and counted.

namespace vantage {
namespace {

using test::Bytes;
using Messages = std::vector<std::pair<std::string, Bytes>>;

TEST(UdpmLink, CountsDatagramsDroppedByTheSocket) {
  constexpr int kSent = 2'000;
  const auto sender = bus::open_transport(test::kUrl);
  const auto receiver = bus::open_transport(
      "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=65536&max_message_size=65536");
  Messages received;
  test::collect(*receiver, "X", received);
  // The kernel reports the total number of drops with the next datagram that it accepts.
  std::int64_t dropped = 0;
  for (int burst = 1; burst <= 3; ++burst) {
    for (int i = 0; i < kSent; ++i) {
      ASSERT_TRUE(sender->publish("X", Bytes(1'000)));
    }
    while (receiver->handle(std::chrono::microseconds{0}) > 0) {
    }
    sender->publish("X", Bytes{1});
    test::handle_until(*receiver, [&] { return received.back().second.size() == 1; });
    EXPECT_GT(receiver->stats().kernel_drops, dropped);
    dropped = receiver->stats().kernel_drops;
    EXPECT_EQ(static_cast<std::int64_t>(received.size()) + dropped, burst * (kSent + 1)) << burst;
  }
}

// The kernel counts datagrams that the filter refuses as dropped, but kernel_drops() does not.
TEST(UdpmLink, ReceivesOnlyChannelsThatPassTheFilter) {
  bus::udpm::MulticastSocket socket(bus::parse_udpm(bus::parse_url(test::kUrl)));
  const std::vector<std::string_view> patterns{"WANTED"};
  const auto filter = bus::udpm::channel_filter(patterns);
  ASSERT_TRUE(filter);
  const auto sender = bus::open_transport(test::kUrl);
  const Bytes payload(16, 1);
  std::vector<std::string> received;
  for (const bool is_filtered : {true, false}) {
    socket.set_filter(is_filtered ? std::span<const sock_filter>(*filter)
                                  : std::span<const sock_filter>());
    for (const char* const channel : {"OTHER", "WANTED2", "WANTED"}) {
      ASSERT_TRUE(sender->publish(channel, payload));
    }
    socket.begin_receiving();
    while (const auto datagram = socket.receive()) {
      received.emplace_back(bus::udpm::parse_packet(datagram->bytes)->channel);
    }
  }
  EXPECT_EQ(received, (std::vector<std::string>{"WANTED", "OTHER", "WANTED2", "WANTED"}));
  EXPECT_EQ(socket.kernel_drops(), 0);
}

// During a flood, handle() returns before it has handled all waiting messages: a handler that takes
// 1 ms is not called for each of them in one call.
TEST(UdpmLink, ReturnsDuringAFlood) {
  constexpr int kSent = 200;
  const auto sender = bus::open_transport(test::kUrl);
  const auto receiver = bus::open_transport(test::kUrl);
  int received = 0;
  receiver->subscribe("X", [&received](std::string_view, std::span<const std::uint8_t>) {
    ++received;
    const std::int64_t until_ns = monotonic_ns() + 1'000'000;
    while (monotonic_ns() < until_ns) {
    }
  });
  for (int i = 0; i < kSent; ++i) {
    ASSERT_TRUE(sender->publish("X", Bytes(100)));
  }
  const int first = receiver->handle(std::chrono::microseconds{0});
  EXPECT_GT(first, 0);
  EXPECT_LE(first, 6) << "5 ms more than the given time";
  while (receiver->handle(std::chrono::microseconds{0}) > 0) {
  }
  EXPECT_EQ(received + receiver->stats().kernel_drops, kSent)
      << "the rest is waiting; nothing is lost";
}

// Each handler call publishes ten new messages, so the queue grows by nine per handled message. The
// oldest messages are dropped, and the newest is received.
TEST(UdpmLink, DropsTheOldestForASlowReader) {
  constexpr std::uint32_t kSent = 5'000;
  constexpr std::size_t kBytes = 500;
  const auto sender = bus::open_transport(test::kUrl);
  const auto receiver = bus::open_transport(
      "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=65536&max_message_size=65536");
  std::uint32_t sent = 0;
  const auto send_one = [&] {
    Bytes bytes(kBytes);
    std::memcpy(bytes.data(), &sent, sizeof sent);
    ++sent;
    ASSERT_TRUE(sender->publish("X", bytes));
  };
  std::int64_t received = 0;
  std::uint32_t newest = 0;
  receiver->subscribe("X", [&](std::string_view, std::span<const std::uint8_t> bytes) {
    const std::uint32_t before = newest;
    std::memcpy(&newest, bytes.data(), sizeof newest);
    EXPECT_TRUE(received == 0 || newest > before) << "in order";
    ++received;
    for (int i = 0; i < 10 && sent < kSent; ++i) {
      send_one();
    }
  });
  send_one();
  while (receiver->handle(std::chrono::milliseconds(10)) > 0) {
  }
  const bus::TransportStats stats = receiver->stats();
  EXPECT_EQ(newest, kSent - 1);
  EXPECT_GT(stats.queue_overflows, 0);
  EXPECT_EQ(received + stats.queue_overflows + stats.kernel_drops, kSent);
}

TEST(UdpmLink, ReportsAReducedReceiveBuffer) {
  constexpr std::int64_t kAsked = 1 << 30;
  const auto greedy = bus::open_transport("udpm://?recv_buf_size=1073741824");
  const bus::TransportStats stats = greedy->stats();
  EXPECT_GT(stats.receive_buffer_bytes, 0);
  EXPECT_EQ(stats.receive_buffer_bytes + stats.receive_buffer_short_bytes, kAsked);
  EXPECT_GT(stats.receive_buffer_short_bytes, 0) << "the kernel does not grant 1 GiB";
  const auto modest = bus::open_transport("udpm://?recv_buf_size=65536");
  EXPECT_EQ(modest->stats().receive_buffer_short_bytes, 0);
}

/// Two cables between network cards of this host: va0 to va1, vb0 to vb1.
class UdpmCards : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(
        std::system("for c in a b; do"
                    " ip link add v${c}0 type veth peer name v${c}1 && ip link set v${c}0 up &&"
                    " ip link set v${c}1 up || exit 1; done;"
                    "ip addr add 10.1.0.1/24 dev va0 && ip addr add 10.1.0.2/24 dev va1 &&"
                    "ip addr add 10.2.0.1/24 dev vb0 && ip addr add 10.2.0.2/24 dev vb1"),
        0);
  }
  void TearDown() override { std::system("ip link del va0; ip link del vb0"); }

  struct Listener {
    explicit Listener(const std::string& options)
        : transport(bus::open_transport("udpm://239.255.76.67:7667?" + options)) {
      test::collect(*transport, "*", received);
    }
    /// Publishes END; returns the channels that were received until END comes back.
    std::string receive_until_end() {
      transport->publish("END", Bytes{1});
      test::handle_until(*transport,
                         [&] { return !received.empty() && received.back().first == "END"; });
      std::string out;
      for (const auto& [channel, bytes] : received) {
        out += channel + " ";
      }
      received.clear();
      return out;
    }
    std::unique_ptr<bus::Transport> transport;
    Messages received;
  };
};

TEST_F(UdpmCards, ReceiveOnlyMessagesSentOnTheSameCard) {
  Listener lo("ttl=0");
  Listener a("ttl=0&interface=va0");
  Listener a_by_address("interface=10.1.0.1");
  Listener b("interface=vb0");
  ASSERT_TRUE(a.transport->publish("A", Bytes{1}));
  ASSERT_TRUE(b.transport->publish("B", Bytes{1}));
  ASSERT_TRUE(lo.transport->publish("LO", Bytes{1}));
  ASSERT_TRUE(a_by_address.transport->publish("A2", Bytes{1}));
  EXPECT_EQ(lo.receive_until_end(), "LO END ");
  EXPECT_EQ(b.receive_until_end(), "B END ");
  EXPECT_EQ(a.receive_until_end(), "A A2 END ");
  EXPECT_EQ(a_by_address.receive_until_end(), "A A2 END END ");
}

TEST_F(UdpmCards, ReceiveMessagesOverTheirCable) {
  // The kernel otherwise refuses packets from outside with this host's own address.
  if (std::system("for key in accept_local=1 rp_filter=0; do for card in all va1 vb1; do"
                  " sysctl -qw net.ipv4.conf.$card.$key || exit 1; done; done") != 0) {
    GTEST_SKIP() << "these settings cannot be changed here";
  }
  Listener far_a("ttl=1&interface=va1");
  Listener far_b("ttl=1&interface=vb1");
  const Listener a("ttl=1&interface=va0");
  const Listener here("ttl=0&interface=vb0");
  ASSERT_TRUE(here.transport->publish("HERE", Bytes{1}));
  ASSERT_TRUE(a.transport->publish("LARGE", test::random_bytes(150'000, 3)));
  test::handle_until(*far_a.transport, [&] { return !far_a.received.empty(); });
  ASSERT_EQ(far_a.received.size(), 1U);
  EXPECT_TRUE(far_a.received[0].second == test::random_bytes(150'000, 3));
  // Both ends of the cable belong to one host. Its kernel (early demultiplexing of multicast, with
  // accept_local) sometimes also delivers a datagram to the socket of the other end; END then
  // arrives twice. HERE was never sent over this cable, so it does not arrive.
  EXPECT_EQ(far_b.receive_until_end().find("HERE"), std::string::npos)
      << "a time to live of 0 does not leave the host";
}

TEST_F(UdpmCards, RefusesMissingCardByName) {
  for (const char* card : {"nosuch0", "10.9.9.9"}) {
    try {
      bus::open_transport("udpm://239.255.76.67:7667?interface=" + std::string(card));
      FAIL() << card;
    } catch (const StartupError& error) {
      EXPECT_NE(std::string(error.what()).find(std::string("interface=") + card), std::string::npos)
          << error.what();
    }
  }
}

// This network has no route to the peer, like a robot out of radio range.
TEST(UdpmLink, DeliversLargeMessagesOnItsHostWithoutAReachablePeer) {
  if (!test::has_large_buffers()) {
    GTEST_SKIP() << test::kNeedsLargeBuffers;
  }
  const auto ours = bus::open_transport(test::kUrl + "&peers=10.99.0.1:7001");
  Messages received;
  test::collect(*ours, "X", received);
  const Bytes large = test::random_bytes(200'000, 1);
  EXPECT_FALSE(ours->publish("X", large)) << "no peer is reachable";
  EXPECT_EQ(ours->stats().send_errors, 1);
  test::handle_until(*ours, [&] { return !received.empty(); });
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].second, large);
}

TEST(UdpmLink, CountsUnsentMessagesAndRecovers) {
  const auto ours = bus::open_transport(test::kUrl);
  Messages received;
  test::collect(*ours, "X", received);
  ASSERT_EQ(std::system("ip link set lo down"), 0);
  EXPECT_FALSE(ours->publish("X", Bytes{1}));
  EXPECT_EQ(ours->stats().send_errors, 1);
  ASSERT_EQ(std::system("ip link set lo up && ip route add 224.0.0.0/4 dev lo"), 0);
  EXPECT_TRUE(ours->publish("X", Bytes{2}));
  test::handle_until(*ours, [&] { return !received.empty(); });
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].second, Bytes{2});
}

}  // namespace
}  // namespace vantage
