#include "wire/crtp/packet.hpp"

namespace vantage::wire::crtp {

Encoded encode(const Packet& packet, std::uint8_t link_bits) {
  Encoded out;
  out.data[0] = static_cast<std::uint8_t>(static_cast<unsigned>(packet.port) << 4U | link_bits |
                                          (packet.channel & 3U));
  std::ranges::copy(packet.payload(), out.data.begin() + 1);
  out.size = std::size_t{1} + packet.size;
  return out;
}

std::optional<Packet> decode(Bytes bytes) {
  if (bytes.empty() || bytes.size() > kPacketMax) {
    return std::nullopt;
  }
  Packet out;
  out.port = static_cast<Port>(bytes[0] >> 4U);
  out.channel = bytes[0] & 3U;
  out.size = static_cast<std::uint8_t>(bytes.size() - 1);
  std::ranges::copy(bytes.subspan(1), out.data.begin());
  return out;
}

}  // namespace vantage::wire::crtp
