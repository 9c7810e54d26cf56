#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace vantage::wire::mavlink {

/// CRC-16/MCRF4XX (X.25 polynomial 0x1021 reflected, initial value 0xFFFF, no final XOR), computed
/// incrementally. Source: MAVLink developer guide, serialization.
class Crc {
 public:
  constexpr void add(std::uint8_t byte) {
    auto mixed = static_cast<std::uint8_t>(byte ^ (value_ & 0xFFU));
    mixed = static_cast<std::uint8_t>(mixed ^ (mixed << 4U));
    const unsigned spread = (unsigned{mixed} << 8U) ^ (unsigned{mixed} << 3U) ^ (mixed >> 4U);
    value_ = static_cast<std::uint16_t>((value_ >> 8U) ^ spread);
  }
  constexpr void add(std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) {
      add(byte);
    }
  }
  constexpr void add(std::string_view text) {
    for (const char c : text) {
      add(static_cast<std::uint8_t>(c));
    }
  }
  [[nodiscard]] constexpr std::uint16_t value() const { return value_; }

 private:
  std::uint16_t value_ = 0xFFFF;
};

}  // namespace vantage::wire::mavlink
