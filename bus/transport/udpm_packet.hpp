#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

// LCM's datagrams, bytes to values and back. Pure. All numbers are big-endian on the wire.
//
//   short     "LC02", u32 sequence, channel, NUL, payload
//   fragment  "LC03", u32 sequence, u32 message bytes, u32 fragment offset, u16 fragment number,
//             u16 fragment count; number 0 goes on with channel, NUL; then payload
// Source: LCM, doc/content/udp-multicast-protocol.md; limits measured with liblcm 1.3.1.

namespace vantage::bus::udpm {

inline constexpr std::size_t kChannelBytesMax = 63;
/// Channel, NUL and payload of a message that travels in one datagram.
inline constexpr std::size_t kShortBytesMax = 65'499;
/// Channel and NUL (first fragment only) and payload of a fragment.
inline constexpr std::size_t kFragmentBytesMax = 65'487;
inline constexpr std::size_t kShortHeaderBytes = 8;
inline constexpr std::size_t kFragmentHeaderBytes = 20;
inline constexpr std::size_t kDatagramBytesMax = 65'507;

/// A datagram whose own statements hold together; views into it, valid as long as it is.
struct Packet {
  bool is_fragment = false;
  std::uint32_t sequence = 0;         ///< of the message, per sender
  std::uint32_t message_bytes = 0;    ///< of the whole payload
  std::uint32_t fragment_offset = 0;  ///< of this payload in the whole
  std::uint16_t fragment_number = 0;
  std::uint16_t fragment_count = 1;
  std::string_view channel;  ///< empty in fragments after the first
  std::span<const std::uint8_t> payload;
};

/// What `datagram` says, or nullopt when it is not LCM's or contradicts itself: too short, channel
/// empty, without NUL or longer than 63 bytes, fragment number not below the count, an empty
/// fragment, or one that reaches beyond its message. Reads nothing outside `datagram`.
std::optional<Packet> parse_packet(std::span<const std::uint8_t> datagram);

/// What goes before the payload of a datagram: header, and channel with NUL if it carries one.
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

/// How a message is cut: 1 fragment stands for a short message.
struct Cut {
  std::size_t fragments = 1;
  std::size_t first_bytes = 0;  ///< payload of the first
};
/// nullopt when the message would take more than 65 535 fragments. Precondition: is_channel_name.
std::optional<Cut> cut_message(std::size_t channel_bytes, std::size_t payload_bytes);

}  // namespace vantage::bus::udpm
