#include "bus/transport/udpm_packet.hpp"

#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::bus::udpm {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes joined(const PacketHead& head, const Bytes& payload) {
  Bytes bytes(head.bytes().begin(), head.bytes().end());
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

TEST(ParsePacket, ReadsAShortMessageWrittenByHand) {
  const Bytes datagram{'L', 'C', '0', '2', 0, 0, 1, 2, 'V', 'I', 0, 9, 8, 7};
  const auto packet = parse_packet(datagram);
  ASSERT_TRUE(packet.has_value());
  EXPECT_FALSE(packet->is_fragment);
  EXPECT_EQ(packet->sequence, 258U);
  EXPECT_EQ(packet->channel, "VI");
  EXPECT_EQ(Bytes(packet->payload.begin(), packet->payload.end()), (Bytes{9, 8, 7}));
}

TEST(ParsePacket, ReadsFragmentsWrittenByHand) {
  const Bytes first{'L', 'C', '0', '3', 0, 0, 0, 5,   0, 0, 0, 4, 0,
                    0,   0,   0,   0,   0, 0, 2, 'A', 0, 1, 2, 3};
  const auto head = parse_packet(first);
  ASSERT_TRUE(head.has_value());
  EXPECT_EQ(head->channel, "A");
  EXPECT_EQ(head->message_bytes, 4U);
  EXPECT_EQ(head->payload.size(), 3U);
  const Bytes second{'L', 'C', '0', '3', 0, 0, 0, 5, 0, 0, 0, 4, 0, 0, 0, 3, 0, 1, 0, 2, 4};
  const auto tail = parse_packet(second);
  ASSERT_TRUE(tail.has_value());
  EXPECT_EQ(tail->fragment_offset, 3U);
  EXPECT_EQ(tail->fragment_number, 1);
  EXPECT_EQ(tail->channel, "");
}

TEST(ParsePacket, ReadsWhatPacketHeadWrites) {
  const Bytes payload{1, 2, 3};
  const auto message = joined(PacketHead::of_short(7, "PLAN_Q1"), payload);
  const auto parsed = parse_packet(message);
  ASSERT_TRUE(parsed.has_value());
  EXPECT_EQ(parsed->sequence, 7U);
  EXPECT_EQ(parsed->channel, "PLAN_Q1");
  const auto fragment =
      joined(PacketHead::of_fragment(8, 200'000, 65'000, 1, 4, "PLAN_Q1"), payload);
  const auto part = parse_packet(fragment);
  ASSERT_TRUE(part.has_value());
  EXPECT_EQ(part->message_bytes, 200'000U);
  EXPECT_EQ(part->fragment_offset, 65'000U);
  EXPECT_EQ(part->fragment_number, 1);
  EXPECT_EQ(part->fragment_count, 4);
}

TEST(ParsePacket, RefusesChannelsThatAreEmptyEndlessOrTooLong) {
  EXPECT_FALSE(parse_packet(Bytes{'L', 'C', '0', '2', 0, 0, 0, 0}).has_value()) << "header only";
  EXPECT_FALSE(parse_packet(Bytes{'L', 'C', '0', '2', 0, 0, 0, 0, 'A', 'B'}).has_value())
      << "no NUL";
  EXPECT_FALSE(parse_packet(Bytes{'L', 'C', '0', '2', 0, 0, 0, 0, 0}).has_value()) << "empty name";
  Bytes datagram{'L', 'C', '0', '2', 0, 0, 0, 0};
  datagram.resize(8 + 63, 'X');
  datagram.push_back(0);
  EXPECT_TRUE(parse_packet(datagram).has_value()) << "63 bytes";
  datagram.insert(datagram.begin() + 8, 'X');
  EXPECT_FALSE(parse_packet(datagram).has_value()) << "64 bytes";
}

Bytes fragment(std::uint32_t message_bytes, std::uint32_t offset, std::uint16_t number,
               std::uint16_t count, const Bytes& payload) {
  return joined(PacketHead::of_fragment(1, message_bytes, offset, number, count, "T"), payload);
}

// The datagrams that crash liblcm 1.3.1.
TEST(ParsePacket, RefusesTheDatagramsThatCrashOthers) {
  EXPECT_FALSE(parse_packet(fragment(0x180, 0xFFFFFF00, 1, 2, Bytes(0x180))).has_value())
      << "offset wraps";
  EXPECT_FALSE(parse_packet(fragment(100, 90, 1, 2, Bytes(11))).has_value()) << "beyond the end";
  EXPECT_TRUE(parse_packet(fragment(100, 90, 1, 2, Bytes(10))).has_value()) << "up to the end";
  const Bytes no_channel{'L', 'C', '0', '3', 0, 0, 0, 5, 0, 0, 0, 9, 0, 0, 0, 1, 0, 0, 0, 1};
  EXPECT_FALSE(parse_packet(no_channel).has_value()) << "fragment 0 without channel";
  Bytes no_nul = no_channel;
  no_nul.push_back('T');
  EXPECT_FALSE(parse_packet(no_nul).has_value()) << "channel without NUL";
}

TEST(ParsePacket, RefusesImpossibleNumbering) {
  EXPECT_FALSE(parse_packet(fragment(100, 0, 0, 0, Bytes(1))).has_value()) << "of no fragments";
  EXPECT_FALSE(parse_packet(fragment(100, 0, 2, 2, Bytes(1))).has_value()) << "number is the count";
  EXPECT_FALSE(parse_packet(fragment(100, 50, 1, 2, {})).has_value()) << "empty fragment";
  EXPECT_FALSE(parse_packet(fragment(3, 0, 1, 4, Bytes(1))).has_value())
      << "more fragments than bytes";
}

// Every view must lie inside the datagram; buffers of exact size let the sanitizer see a step over.
TEST(ParsePacket, StaysInsideRandomAndTruncatedDatagrams) {
  std::mt19937_64 rng(11);
  int accepted = 0;
  for (int i = 0; i < 50'000; ++i) {
    Bytes datagram(rng() % 40);
    for (auto& byte : datagram) {
      byte = static_cast<std::uint8_t>(rng() % 4 == 0 ? 0 : rng());
    }
    if (datagram.size() >= 4 && rng() % 8 != 0) {
      const char* magic = rng() % 2 == 0 ? "LC02" : "LC03";
      std::copy(magic, magic + 4, datagram.begin());
      if (datagram.size() >= 20 && rng() % 2 == 0) {
        std::fill(datagram.begin() + 8, datagram.begin() + 20, std::uint8_t{0});
        datagram[11] = static_cast<std::uint8_t>(rng() % 32);
        datagram[15] = static_cast<std::uint8_t>(rng() % 4);
        datagram[17] = static_cast<std::uint8_t>(rng() % 3);
        datagram[19] = static_cast<std::uint8_t>(rng() % 4);
      }
    }
    const auto packet = parse_packet(datagram);
    if (!packet) {
      continue;
    }
    ++accepted;
    ASSERT_LE(packet->channel.size(), kChannelBytesMax);
    ASSERT_EQ(packet->payload.data() + packet->payload.size(), datagram.data() + datagram.size());
    ASSERT_LE(std::uint64_t{packet->fragment_offset} + packet->payload.size(),
              packet->message_bytes);
  }
  EXPECT_GT(accepted, 1'000);
}

TEST(CutMessage, KeepsToTheLimitsMeasuredOfLcm) {
  const auto at_limit = cut_message(4, kShortBytesMax - 5);
  ASSERT_TRUE(at_limit.has_value());
  EXPECT_EQ(at_limit->fragments, 1U);
  const auto above = cut_message(4, kShortBytesMax - 4);
  ASSERT_TRUE(above.has_value());
  EXPECT_EQ(above->fragments, 2U);
  EXPECT_EQ(above->first_bytes, kFragmentBytesMax - 5);
  EXPECT_FALSE(cut_message(4, kFragmentBytesMax * 65'535).has_value());
}

TEST(IsChannelName, AllowsOneTo63Bytes) {
  EXPECT_FALSE(is_channel_name(""));
  EXPECT_TRUE(is_channel_name(std::string(63, 'C')));
  EXPECT_FALSE(is_channel_name(std::string(64, 'C')));
  EXPECT_FALSE(is_channel_name(std::string_view("A\0B", 3)));
}

}  // namespace
}  // namespace vantage::bus::udpm
