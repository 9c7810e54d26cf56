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

TEST(ParsePacket, ReadsTheOutputOfPacketHead) {
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

TEST(ParsePacket, RefusesEmptyUnterminatedAndLongChannels) {
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

// These datagrams crash liblcm 1.3.1.
TEST(ParsePacket, RefusesDatagramsThatCrashOtherReceivers) {
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
  EXPECT_FALSE(parse_packet(fragment(100, 0, 0, 0, Bytes(1))).has_value())
      << "the number of fragments is 0";
  EXPECT_FALSE(parse_packet(fragment(100, 0, 2, 2, Bytes(1))).has_value())
      << "the fragment number equals the count";
  EXPECT_FALSE(parse_packet(fragment(100, 50, 1, 2, {})).has_value()) << "empty fragment";
  EXPECT_FALSE(parse_packet(fragment(3, 0, 1, 4, Bytes(1))).has_value())
      << "more fragments than bytes";
}

// Tests all values of each byte of each number, and every length of a channel name.
TEST(ParsePacket, ReadsEveryValidHead) {
  std::mt19937_64 rng(12);
  for (int i = 0; i < 5'000; ++i) {
    const auto sequence = static_cast<std::uint32_t>(rng());
    const std::string channel(1 + rng() % 63, static_cast<char>('A' + rng() % 26));
    const Bytes payload(1 + rng() % 9, static_cast<std::uint8_t>(rng()));
    const Bytes message = joined(PacketHead::of_short(sequence, channel), payload);
    ASSERT_EQ(message.size(), 8 + channel.size() + 1 + payload.size());
    const auto whole = parse_packet(message);
    ASSERT_TRUE(whole.has_value());
    EXPECT_FALSE(whole->is_fragment);
    EXPECT_EQ(whole->sequence, sequence);
    EXPECT_EQ(whole->channel, channel);
    EXPECT_EQ(whole->message_bytes, payload.size());
    EXPECT_EQ(whole->fragment_count, 1);
    EXPECT_EQ(Bytes(whole->payload.begin(), whole->payload.end()), payload);

    const auto message_bytes = static_cast<std::uint32_t>(100'000 + rng() % 4'000'000'000);
    const auto offset = static_cast<std::uint32_t>(rng() % (message_bytes - 10));
    const auto count = static_cast<std::uint16_t>(1 + rng() % 65'535);
    const auto number = static_cast<std::uint16_t>(rng() % 4 == 0 ? 0 : rng() % count);
    const Bytes piece = joined(
        PacketHead::of_fragment(sequence, message_bytes, offset, number, count, channel), payload);
    ASSERT_EQ(piece.size(), 20 + (number == 0 ? channel.size() + 1 : 0) + payload.size());
    const auto part = parse_packet(piece);
    ASSERT_TRUE(part.has_value());
    EXPECT_TRUE(part->is_fragment);
    EXPECT_EQ(part->sequence, sequence);
    EXPECT_EQ(part->message_bytes, message_bytes);
    EXPECT_EQ(part->fragment_offset, offset);
    EXPECT_EQ(part->fragment_number, number);
    EXPECT_EQ(part->fragment_count, count);
    EXPECT_EQ(part->channel, number == 0 ? channel : "");
    EXPECT_EQ(Bytes(part->payload.begin(), part->payload.end()), payload);
  }
}

TEST(ParsePacket, AcceptsOneFragmentPerByte) {
  EXPECT_TRUE(parse_packet(fragment(4, 3, 3, 4, Bytes(1))).has_value());
  EXPECT_FALSE(parse_packet(fragment(4, 3, 3, 5, Bytes(1))).has_value());
  const auto bytes = fragment(1, 0, 0, 1, Bytes(1));  // the parsed packet refers to `bytes`
  const auto whole = parse_packet(bytes);
  ASSERT_TRUE(whole.has_value());
  EXPECT_EQ(whole->channel, "T");
}

TEST(PacketHead, ShortensALongName) {
  const Bytes bytes = joined(PacketHead::of_short(1, std::string(64, 'N')), {5});
  const auto packet = parse_packet(bytes);
  ASSERT_TRUE(packet.has_value());
  EXPECT_EQ(packet->channel, std::string(63, 'N'));
}

// Every view must lie inside the datagram. The buffers have the exact size, so the sanitizer
// detects a read beyond the end.
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

TEST(CutMessage, KeepsTheMeasuredLimitsOfLcm) {
  const auto at_limit = cut_message(4, kShortBytesMax - 5);
  ASSERT_TRUE(at_limit.has_value());
  EXPECT_EQ(at_limit->fragments, 1U);
  const auto above = cut_message(4, kShortBytesMax - 4);
  ASSERT_TRUE(above.has_value());
  EXPECT_EQ(above->fragments, 2U);
  EXPECT_EQ(above->first_bytes, kFragmentBytesMax - 5);
  EXPECT_FALSE(cut_message(4, kFragmentBytesMax * 65'535).has_value());
}

// A UDP packet over IPv4 carries 65 535 bytes minus the two headers, of 20 and 8 bytes.
TEST(CutMessage, FillsDatagramsCompletely) {
  EXPECT_EQ(kDatagramBytesMax, 65'535U - 20U - 8U);
  EXPECT_EQ(kShortHeaderBytes + kShortBytesMax, kDatagramBytesMax);
  EXPECT_EQ(kFragmentHeaderBytes + kFragmentBytesMax, kDatagramBytesMax);
}

TEST(CutMessage, MinimisesTheNumberOfFragments) {
  for (const std::size_t channel : {1U, 4U, 63U}) {
    for (std::size_t pieces = 2; pieces <= 65'535; pieces += pieces < 10 ? 1 : 13'105) {
      const std::size_t most = pieces * kFragmentBytesMax - channel - 1;
      const auto cut = cut_message(channel, most);
      ASSERT_TRUE(cut.has_value()) << pieces;
      EXPECT_EQ(cut->fragments, pieces);
      EXPECT_EQ(cut->first_bytes, kFragmentBytesMax - channel - 1);
      EXPECT_EQ(cut->first_bytes + (pieces - 1) * kFragmentBytesMax, most);
      const auto more = cut_message(channel, most + 1);
      ASSERT_EQ(more.has_value(), pieces < 65'535) << pieces;
      EXPECT_TRUE(!more || more->fragments == pieces + 1);
    }
    EXPECT_EQ(cut_message(channel, 5)->first_bytes, 5U);
    EXPECT_EQ(cut_message(channel, 0)->fragments, 1U);
  }
}

TEST(IsChannelName, AllowsOneTo63Bytes) {
  EXPECT_FALSE(is_channel_name(""));
  EXPECT_TRUE(is_channel_name(std::string(63, 'C')));
  EXPECT_FALSE(is_channel_name(std::string(64, 'C')));
  EXPECT_FALSE(is_channel_name(std::string_view("A\0B", 3)));
}

}  // namespace
}  // namespace vantage::bus::udpm
