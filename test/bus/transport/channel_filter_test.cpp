#include "bus/transport/channel_filter.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "bus/transport/channel_pattern.hpp"
#include "bus/transport/udpm_packet.hpp"

namespace vantage::bus::udpm {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kUdpHeaderBytes = 8;

std::uint32_t number_at(const Bytes& packet, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    value = (value << 8U) | packet[at + i];
  }
  return value;
}

/// Runs a filter as the kernel does: a load beyond the end drops the packet.
/// Source: Linux, Documentation/networking/filter.rst.
bool passes(const std::vector<sock_filter>& program, const Bytes& packet) {
  std::uint32_t accumulator = 0;
  for (std::size_t at = 0; at < program.size(); ++at) {
    const sock_filter& step = program[at];
    const std::size_t size = BPF_SIZE(step.code) == BPF_W   ? 4
                             : BPF_SIZE(step.code) == BPF_H ? 2
                                                            : 1;
    switch (BPF_CLASS(step.code)) {
      case BPF_LD:
        if (BPF_MODE(step.code) == BPF_LEN) {
          accumulator = static_cast<std::uint32_t>(packet.size());
        } else if (step.k + size > packet.size()) {
          return false;
        } else {
          accumulator = number_at(packet, step.k, size);
        }
        break;
      case BPF_JMP:
        at += (BPF_OP(step.code) == BPF_JEQ ? accumulator == step.k : accumulator >= step.k)
                  ? step.jt
                  : step.jf;
        break;
      default:
        return step.k > 0;
    }
  }
  ADD_FAILURE() << "the program has no end";
  return false;
}

Bytes packet_of(std::span<const std::uint8_t> head, std::size_t payload_bytes) {
  Bytes out(kUdpHeaderBytes, 0);
  out.insert(out.end(), head.begin(), head.end());
  out.resize(out.size() + payload_bytes, 'A');
  return out;
}

/// Returns all texts of A and B with 1 to `length_max` letters.
std::vector<std::string> texts(std::size_t length_max) {
  std::vector<std::string> out{"A", "B"};
  for (std::size_t i = 0; out[i].size() < length_max; ++i) {
    out.push_back(out[i] + "A");
    out.push_back(out[i] + "B");
  }
  return out;
}

// Tests all pairs of patterns of up to five letters, exact and as prefix, by brute force. The
// channels have up to six letters; the payload is empty or continues the name.
TEST(ChannelFilter, PassesExactlyTheMatchingChannels) {
  const std::vector<std::string> channels = texts(6);
  std::vector<std::string> patterns;
  for (const std::string& text : texts(5)) {
    patterns.push_back(text);
    patterns.push_back(text + "*");
  }
  for (std::size_t i = 0; i < patterns.size(); ++i) {
    const std::vector<std::string_view> pair{patterns[i], patterns[(7 * i + 3) % patterns.size()]};
    const auto program = channel_filter(pair);
    ASSERT_TRUE(program);
    for (const std::string& channel : channels) {
      const bool is_wanted = std::any_of(pair.begin(), pair.end(), [&](std::string_view pattern) {
        return channel_matches(pattern, channel);
      });
      for (const std::size_t payload : {0U, 9U}) {
        const PacketHead head = PacketHead::of_short(7, channel);
        EXPECT_EQ(passes(*program, packet_of(head.bytes(), payload)), is_wanted)
            << pair[0] << ' ' << pair[1] << ' ' << channel << ' ' << payload;
      }
    }
  }
}

// Only the first fragment contains the channel, and malformed datagrams are counted.
TEST(ChannelFilter, PassesFragmentsAndMalformedDatagrams) {
  const std::vector<std::string_view> patterns{"VICON"};
  const auto program = channel_filter(patterns);
  ASSERT_TRUE(program);
  for (const std::uint16_t number : {std::uint16_t{0}, std::uint16_t{1}}) {
    const PacketHead head =
        PacketHead::of_fragment(1, 100'000, number == 0 ? 0 : 65'000, number, 2, "OTHER");
    EXPECT_TRUE(passes(*program, packet_of(head.bytes(), 10)));
  }
  EXPECT_TRUE(passes(*program, packet_of(Bytes{'L', 'C', '9', '9', 0, 0, 0, 0}, 20)));
}

TEST(ChannelFilter, PassesNothingWithoutPatterns) {
  const auto program = channel_filter({});
  ASSERT_TRUE(program);
  EXPECT_FALSE(passes(*program, packet_of(PacketHead::of_short(1, "VICON").bytes(), 9)));
}

TEST(ChannelFilter, IsOmittedForAllChannelsAndForTooManyNames) {
  const std::vector<std::string_view> all{"VICON", "*"};
  EXPECT_FALSE(channel_filter(all));
  std::vector<std::string> names;
  for (int i = 0; i < 500; ++i) {
    names.push_back("BELIEF_Q" + std::to_string(i));
  }
  const std::vector<std::string_view> many(names.begin(), names.end());
  EXPECT_FALSE(channel_filter(many));
}

// The longest name needs the most instructions, whose jumps must fit into eight bits.
TEST(ChannelFilter, SupportsNamesOfTheGreatestLength) {
  const std::string longest(kChannelBytesMax, 'C');
  const std::string too_long = longest + "C";
  const std::vector<std::string_view> patterns{too_long, longest, "B"};
  const auto program = channel_filter(patterns);
  ASSERT_TRUE(program);
  EXPECT_TRUE(passes(*program, packet_of(PacketHead::of_short(1, longest).bytes(), 9)));
  EXPECT_TRUE(passes(*program, packet_of(PacketHead::of_short(1, "B").bytes(), 9)));
  EXPECT_FALSE(passes(*program, packet_of(PacketHead::of_short(1, longest.substr(1)).bytes(), 9)));
}

}  // namespace
}  // namespace vantage::bus::udpm
