#include "bus/transport/udpm_packet.hpp"

#include <algorithm>
#include <limits>

namespace vantage::bus::udpm {
namespace {

constexpr std::uint32_t kFragmentMagic = 0x4C433033;  // "LC03"

/// Returns the big-endian number in `width` bytes at `at`. Precondition: these bytes exist.
std::uint32_t number(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t width) {
  std::uint32_t value = 0;
  for (const std::uint8_t byte : bytes.subspan(at, width)) {
    value = (value << 8U) | byte;
  }
  return value;
}

/// Removes the channel name from the start of `rest` and stores it in `channel`. Returns false when
/// the name is empty, too long or not terminated.
bool take_channel(std::span<const std::uint8_t>& rest, std::string_view& channel) {
  const auto searched = rest.first(std::min(rest.size(), kChannelBytesMax + 1));
  const auto nul = std::find(searched.begin(), searched.end(), std::uint8_t{0});
  const auto length = static_cast<std::size_t>(nul - searched.begin());
  if (nul == searched.end() || length == 0) {
    return false;
  }
  channel = {reinterpret_cast<const char*>(rest.data()), length};
  rest = rest.subspan(length + 1);
  return true;
}

}  // namespace

std::optional<Packet> parse_packet(std::span<const std::uint8_t> datagram) {
  if (datagram.size() < kShortHeaderBytes) {
    return std::nullopt;
  }
  Packet packet;
  packet.sequence = number(datagram, 4, 4);
  const std::uint32_t magic = number(datagram, 0, 4);
  if (magic == kShortMagic) {
    packet.payload = datagram.subspan(kShortHeaderBytes);
    if (!take_channel(packet.payload, packet.channel)) {
      return std::nullopt;
    }
    packet.message_bytes = static_cast<std::uint32_t>(packet.payload.size());
    return packet;
  }
  if (magic != kFragmentMagic || datagram.size() < kFragmentHeaderBytes) {
    return std::nullopt;
  }
  packet.is_fragment = true;
  packet.message_bytes = number(datagram, 8, 4);
  packet.fragment_offset = number(datagram, 12, 4);
  packet.fragment_number = static_cast<std::uint16_t>(number(datagram, 16, 2));
  packet.fragment_count = static_cast<std::uint16_t>(number(datagram, 18, 2));
  packet.payload = datagram.subspan(kFragmentHeaderBytes);
  if (packet.fragment_number >= packet.fragment_count ||
      packet.fragment_count > packet.message_bytes ||  // each fragment carries at least one byte
      (packet.fragment_number == 0 && !take_channel(packet.payload, packet.channel))) {
    return std::nullopt;
  }
  const std::uint64_t end = std::uint64_t{packet.fragment_offset} + packet.payload.size();
  if (packet.payload.empty() || end > packet.message_bytes) {
    return std::nullopt;
  }
  return packet;
}

PacketHead PacketHead::of_short(std::uint32_t sequence, std::string_view channel) {
  PacketHead head;
  head.put(kShortMagic, 4);
  head.put(sequence, 4);
  head.put_channel(channel);
  return head;
}

PacketHead PacketHead::of_fragment(std::uint32_t sequence, std::uint32_t message_bytes,
                                   std::uint32_t fragment_offset, std::uint16_t fragment_number,
                                   std::uint16_t fragment_count, std::string_view channel) {
  PacketHead head;
  head.put(kFragmentMagic, 4);
  head.put(sequence, 4);
  head.put(message_bytes, 4);
  head.put(fragment_offset, 4);
  head.put(fragment_number, 2);
  head.put(fragment_count, 2);
  if (fragment_number == 0) {
    head.put_channel(channel);
  }
  return head;
}

void PacketHead::put(std::uint64_t value, std::size_t width) {
  for (std::size_t i = width; i > 0; --i) {
    bytes_[size_++] = static_cast<std::uint8_t>(value >> (8U * (i - 1)));
  }
}

void PacketHead::put_channel(std::string_view channel) {
  for (const char each : channel.substr(0, kChannelBytesMax)) {
    bytes_[size_++] = static_cast<std::uint8_t>(each);
  }
  bytes_[size_++] = 0;
}

bool is_channel_name(std::string_view channel) {
  return !channel.empty() && channel.size() <= kChannelBytesMax &&
         channel.find('\0') == std::string_view::npos;
}

std::optional<Cut> cut_message(std::size_t channel_bytes, std::size_t payload_bytes) {
  const std::size_t total = channel_bytes + 1 + payload_bytes;
  if (total <= kShortBytesMax) {
    return Cut{1, payload_bytes};
  }
  const std::size_t fragments = (total + kFragmentBytesMax - 1) / kFragmentBytesMax;
  if (fragments > std::numeric_limits<std::uint16_t>::max()) {
    return std::nullopt;
  }
  return Cut{fragments, kFragmentBytesMax - channel_bytes - 1};
}

}  // namespace vantage::bus::udpm
