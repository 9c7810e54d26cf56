#pragma once

#include <cstddef>
#include <limits>

#include "bus/auth/trailer.hpp"
#include "bus/convert/wire_walk.hpp"

namespace vantage::bus {

template <class Wire>
std::optional<Wire> decode_wire(std::span<const std::uint8_t> message) {
  const std::span<const std::uint8_t> bytes = auth::payload_of(message);
  static const WireSchema* const kSchema = find_wire_schema(Wire::getTypeName());
  constexpr std::size_t kFingerprintBytes = 8;
  if (kSchema == nullptr || bytes.size() < kFingerprintBytes ||
      bytes.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    return std::nullopt;
  }
  std::uint64_t fingerprint = 0;
  for (const std::uint8_t byte : bytes.first(kFingerprintBytes)) {
    fingerprint = (fingerprint << 8U) | byte;
  }
  if (fingerprint != static_cast<std::uint64_t>(Wire::getHash()) ||
      !is_well_formed(*kSchema, bytes.subspan(kFingerprintBytes))) {
    return std::nullopt;
  }
  std::optional<Wire> wire{std::in_place};
  const int size = static_cast<int>(bytes.size());
  if (wire->decode(bytes.data(), 0, size) != size) {
    return std::nullopt;
  }
  return wire;
}

}  // namespace vantage::bus
