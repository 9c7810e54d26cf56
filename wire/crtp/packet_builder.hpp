#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "wire/crtp/packet.hpp"

namespace vantage::wire::crtp {

/// Writer of a packet's payload. A value that its field cannot represent, or too many bytes, make
/// finish() return nullopt.
class PacketBuilder {
 public:
  PacketBuilder(Port port, int channel) {
    packet_.port = port;
    packet_.channel = static_cast<std::uint8_t>(channel);
  }

  PacketBuilder& u8(unsigned value) { return append(value, 1); }
  PacketBuilder& u16(unsigned value) { return append(value, 2); }
  PacketBuilder& u32(std::uint32_t value) { return append(value, 4); }
  /// Appends the nearest integer to `value`; refuses numbers outside ± 32767.
  PacketBuilder& i16(double value) {
    const double rounded = std::round(value);
    if (!(std::abs(rounded) <= std::numeric_limits<std::int16_t>::max())) {
      is_ok_ = false;
      return *this;
    }
    return u16(static_cast<std::uint16_t>(static_cast<std::int16_t>(rounded)));
  }
  PacketBuilder& f32(double value) {
    const auto single = static_cast<float>(value);
    is_ok_ = is_ok_ && std::isfinite(single);
    return u32(std::bit_cast<std::uint32_t>(single));
  }
  PacketBuilder& text(std::string_view text) {
    for (const char c : text) {
      u8(static_cast<std::uint8_t>(c));
    }
    return *this;
  }
  PacketBuilder& bytes(Bytes bytes) {
    for (const std::uint8_t byte : bytes) {
      u8(byte);
    }
    return *this;
  }
  /// Refuses the packet unless `condition` holds.
  PacketBuilder& check(bool condition) {
    is_ok_ = is_ok_ && condition;
    return *this;
  }
  /// Returns a packet whose content always fits.
  [[nodiscard]] Packet packet() const { return packet_; }
  [[nodiscard]] std::optional<Packet> finish() const {
    return is_ok_ ? std::optional(packet_) : std::nullopt;
  }

 private:
  PacketBuilder& append(std::uint32_t value, std::size_t count) {
    if (packet_.size + count > kPayloadMax) {
      is_ok_ = false;
      return *this;
    }
    for (std::size_t i = 0; i < count; ++i) {
      packet_.data[packet_.size++] = static_cast<std::uint8_t>(value >> (8U * i));
    }
    return *this;
  }

  Packet packet_;
  bool is_ok_ = true;
};

}  // namespace vantage::wire::crtp
