#pragma once

#include <cstddef>
#include <optional>

#include <lcm/lcm-cpp.hpp>

#include "bus/auth/trailer.hpp"
#include "bus/convert/convert.hpp"

namespace vantage::test {

/// Decodes the message of `event`, which LCM's own reader has read; the message may be signed.
/// Returns nullopt if the message is not a Wire or its content is invalid.
template <class Message, class Wire>
std::optional<Message> decode(const lcm::LogEvent& event) {
  Wire wire;
  const bus::auth::Bytes payload = bus::auth::payload_of(
      {static_cast<const std::uint8_t*>(event.data), static_cast<std::size_t>(event.datalen)});
  const auto size = static_cast<int>(payload.size());
  if (wire.decode(payload.data(), 0, size) != size) {
    return std::nullopt;
  }
  return bus::from_wire(wire);
}

}  // namespace vantage::test
