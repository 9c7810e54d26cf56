#pragma once

#include <optional>

#include <lcm/lcm-cpp.hpp>

#include "bus/convert/convert.hpp"

namespace vantage::test {

/// The message in `event`, of LCM's own reader; nullopt when it is not a Wire or cannot be true.
template <class Message, class Wire>
std::optional<Message> decode(const lcm::LogEvent& event) {
  Wire wire;
  if (wire.decode(event.data, 0, event.datalen) != event.datalen) {
    return std::nullopt;
  }
  return bus::from_wire(wire);
}

}  // namespace vantage::test
