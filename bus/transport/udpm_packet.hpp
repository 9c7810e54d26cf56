#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

// Encodes and decodes LCM's datagrams. All numbers in a datagram are big-endian.
//
//   short     "LC02", u32 sequence, channel, NUL, payload
//   fragment  "LC03", u32 sequence, u32 message bytes, u32 fragment offset, u16 fragment number,
//             u16 fragment count; then channel, NUL in fragment 0; payload
// Source: LCM, doc/content/udp-multicast-protocol.md; limits measured with liblcm 1.3.1.

namespace vantage::bus::udpm {

/// "LC02", the first bytes of a short datagram
inline constexpr std::uint32_t kShortMagic = 0x4C433032;
inline constexpr std::size_t kChannelBytesMax = 63;
/// Maximum total size of channel name, NUL and payload of a message in one datagram, bytes.
inline constexpr std::size_t kShortBytesMax = 65'499;
/// Maximum total size of a fragment's payload and, in the first fragment, channel name and NUL,
/// bytes.
inline constexpr std::size_t kFragmentBytesMax = 65'487;
inline constexpr std::size_t kShortHeaderBytes = 8;
inline constexpr std::size_t kFragmentHeaderBytes = 20;
inline constexpr std::size_t kDatagramBytesMax = 65'507;

/// Parsed datagram with consistent header fields. Its views are valid as long as the datagram
/// exists.
struct Packet {
  bool is_fragment = false;
  std::uint32_t sequence = 0;         ///< sequence number of the message, per sender
  std::uint32_t message_bytes = 0;    ///< size of the message's complete payload
  std::uint32_t fragment_offset = 0;  ///< offset of this fragment in the payload
  std::uint16_t fragment_number = 0;
  std::uint16_t fragment_count = 1;
  std::string_view channel;  ///< empty in fragments after the first
  std::span<const std::uint8_t> payload;
};

/// Parses `datagram`. Returns nullopt when it is not in LCM's format or is inconsistent: too short;
/// channel name empty, longer than 63 bytes or without NUL; fragment number not below the count;
/// fragment empty or beyond the end of its message. Reads nothing outside `datagram`.
std::optional<Packet> parse_packet(std::span<const std::uint8_t> datagram);

/// Part of a datagram before the payload: header and, if present, channel name with NUL.
class PacketHead {
 public:
  static PacketHead of_short(std::uint32_t sequence, std::string_view channel);
  /// `channel` is written when `fragment_number` is 0.
  static PacketHead of_fragment(std::uint32_t sequence, std::uint32_t message_bytes,
                                std::uint32_t fragment_offset, std::uint16_t fragment_number,
                                std::uint16_t fragment_count, std::string_view channel);
  [[nodiscard]] std::span<const std::uint8_t> bytes() const {
    return std::span(bytes_).first(size_);
  }

 private:
  void put(std::uint64_t value, std::size_t width);
  void put_channel(std::string_view channel);

  std::array<std::uint8_t, kFragmentHeaderBytes + kChannelBytesMax + 1> bytes_{};
  std::size_t size_ = 0;
};

/// True for a name that LCM can carry: 1 to 63 bytes without NUL.
bool is_channel_name(std::string_view channel);

/// Division of a message into fragments; 1 fragment means a short message.
struct Cut {
  std::size_t fragments = 1;
  std::size_t first_bytes = 0;  ///< payload bytes in the first fragment
};
/// Returns the division of a message; nullopt when it needs more than 65 535 fragments.
/// Precondition: is_channel_name.
std::optional<Cut> cut_message(std::size_t channel_bytes, std::size_t payload_bytes);

}  // namespace vantage::bus::udpm
