#include <algorithm>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "bus/transport/udpm_packet.hpp"
#include "test/integration/network_support.hpp"
#include "test/support/resident_memory.hpp"

// Sends datagrams that crash, confuse or fill other receivers, between valid ones.

namespace vantage {
namespace {

using test::Bytes;
using test::resident_kib;

/// Sends raw datagrams to the group from its own port.
class Attacker {
 public:
  Attacker() : fd_(socket(AF_INET, SOCK_DGRAM, 0)) {
    group_.sin_family = AF_INET;
    group_.sin_port = htons(7667);
    inet_pton(AF_INET, "239.255.76.67", &group_.sin_addr);
  }
  ~Attacker() { close(fd_); }
  Attacker(const Attacker&) = delete;
  Attacker& operator=(const Attacker&) = delete;
  Attacker(Attacker&&) = delete;
  Attacker& operator=(Attacker&&) = delete;

  void send(const Bytes& datagram) {
    sendto(fd_, datagram.data(), datagram.size(), 0, reinterpret_cast<sockaddr*>(&group_),
           sizeof group_);
  }

 private:
  int fd_;
  sockaddr_in group_{};
};

Bytes datagram(const bus::udpm::PacketHead& head, std::size_t payload_bytes) {
  Bytes bytes(head.bytes().begin(), head.bytes().end());
  bytes.resize(bytes.size() + payload_bytes, 0xAA);
  return bytes;
}

Bytes fragment(std::uint32_t sequence, std::uint32_t size, std::uint32_t offset,
               std::uint16_t number, std::uint16_t count, std::size_t payload_bytes) {
  return datagram(bus::udpm::PacketHead::of_fragment(sequence, size, offset, number, count, "GOOD"),
                  payload_bytes);
}

Bytes hostile_datagram(std::mt19937& rng) {
  const Bytes header_only{'L', 'C', '0', '2', 0, 0, 0, 0};
  const Bytes without_nul{'L', 'C', '0', '2', 0, 0, 0, 0, 'G', 'O', 'O', 'D'};
  switch (rng() % 9) {
    case 0: {
      Bytes junk = test::random_bytes(rng() % 1'500, static_cast<unsigned>(rng()));
      return junk;
    }
    case 1:
      return header_only;
    case 2:
      return without_nul;
    case 3:  // SIGSEGV in liblcm: out-of-bounds write
      return fragment(static_cast<std::uint32_t>(rng()), 0x180, 0xFFFFFF00, 1, 2, 0x180);
    case 4: {  // SIGSEGV in liblcm: no channel, no payload, offset 1
      Bytes bytes = fragment(static_cast<std::uint32_t>(rng()), 9, 1, 0, 1, 0);
      bytes.resize(20);
      return bytes;
    }
    case 5:  // announces 4 MiB and sends no more
      return fragment(static_cast<std::uint32_t>(rng()), 4U << 20U, 0, 0, 65, 10);
    case 6:  // announces 4 GiB
      return fragment(static_cast<std::uint32_t>(rng()), 0xFFFFFFFF, 0, 0, 65'535, 10);
    case 7:  // only the first half of a datagram
      return fragment(static_cast<std::uint32_t>(rng()), 100'000, 0, 0, 2, 50'000);
    default:  // a valid header with one bit flipped
      Bytes bytes = fragment(static_cast<std::uint32_t>(rng() % 8), 200, 0, 0, 2, 100);
      bytes[rng() % 20] ^= static_cast<std::uint8_t>(1U << (rng() % 8));
      return bytes;
  }
}

// Sends 20 hostile datagrams after each valid message, for 500 rounds. Every 10th valid message has
// 200 kB and comes from a sender that the attackers do not know. The attackers change their port
// from time to time.
TEST(UdpmUnderAttack, LosesNoValidMessageAndBoundsItsMemory) {
  if (!test::has_large_buffers()) {
    GTEST_SKIP() << test::kNeedsLargeBuffers;
  }
  constexpr unsigned kRounds = 500;
  const auto victim = bus::open_transport(test::kUrl);
  const auto friendly = bus::open_transport(test::kUrl);
  std::vector<std::pair<std::string, Bytes>> received;
  test::collect(*victim, "WANTED", received);
  std::mt19937 rng(99);
  auto attacker = std::make_unique<Attacker>();
  const std::int64_t before_kib = resident_kib();
  std::int64_t most_kib = 0;
  for (unsigned round = 0; round < kRounds; ++round) {
    const std::size_t size = round % 10 == 0 ? 200'000 : 200;
    ASSERT_TRUE(friendly->publish("WANTED", test::random_bytes(size, round)));
    for (int i = 0; i < 20; ++i) {
      attacker->send(hostile_datagram(rng));
    }
    if (round % 5 == 0) {
      attacker = std::make_unique<Attacker>();
    }
    test::handle_until(*victim, [&] { return received.size() > round; });
    ASSERT_EQ(received.size(), round + 1U);
    ASSERT_TRUE(received.back().second == test::random_bytes(size, round));
    received.back().second.clear();
    received.back().second.shrink_to_fit();
    most_kib = std::max(most_kib, resident_kib());
  }
  const bus::TransportStats stats = victim->stats();
  RecordProperty("memory_growth_kib", std::to_string(most_kib - before_kib));
  EXPECT_EQ(stats.messages_received, kRounds);
  EXPECT_EQ(stats.kernel_drops, 0);
  EXPECT_GT(stats.malformed_datagrams, 0);
  EXPECT_GT(stats.incomplete_messages, 0);
  EXPECT_GT(stats.oversized_messages, 0);
  if (!test::kKeepsFreedMemory) {
    EXPECT_LT(most_kib - before_kib, 64 * 1024) << "KiB";
  }
}

// An attacker's fragments arrive between those of a valid message, with the same sequence number
// but from another port. They must not be assembled into the valid message.
TEST(UdpmUnderAttack, KeepsForeignFragmentsOutOfMessages) {
  if (!test::has_large_buffers()) {
    GTEST_SKIP() << test::kNeedsLargeBuffers;
  }
  const auto victim = bus::open_transport(test::kUrl);
  const auto friendly = bus::open_transport(test::kUrl);
  std::vector<std::pair<std::string, Bytes>> received;
  test::collect(*victim, "*", received);
  Attacker attacker;
  for (unsigned round = 0; round < 50; ++round) {
    attacker.send(fragment(round, 150'000, 65'000, 1, 3, 65'000));
    attacker.send(fragment(round, 150'000, 0, 0, 3, 65'000));
    friendly->publish("WANTED", test::random_bytes(150'000, round));
    test::handle_until(*victim, [&] { return received.size() > round; });
    ASSERT_EQ(received.size(), round + 1U);
    ASSERT_EQ(received.back().first, "WANTED");
    ASSERT_TRUE(received.back().second == test::random_bytes(150'000, round));
  }
}

// The reassembly limits per sender and in total grow with the configured largest message: one
// message of that size is always assembled.
TEST(UdpmReassembly, AssemblesAMessageOfTheMaximumSize) {
  constexpr std::uint32_t kPieceBytes = 60'000;
  constexpr std::uint16_t kPieces = 600;
  constexpr std::uint32_t kMessageBytes = kPieces * kPieceBytes;
  const auto listener =
      bus::open_transport(test::kUrl + "&max_message_size=" + std::to_string(kMessageBytes));
  std::vector<std::pair<std::string, Bytes>> received;
  test::collect(*listener, "*", received);
  Attacker stranger;
  for (std::uint16_t i = 0; i < kPieces; ++i) {
    stranger.send(fragment(1, kMessageBytes, i * kPieceBytes, i, kPieces, kPieceBytes));
    listener->handle(std::chrono::microseconds{0});
  }
  test::handle_until(*listener, [&] { return !received.empty(); });
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].second, Bytes(kMessageBytes, 0xAA));
  EXPECT_EQ(listener->stats().incomplete_messages, 0);
}

}  // namespace
}  // namespace vantage
