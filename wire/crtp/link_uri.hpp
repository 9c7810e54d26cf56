#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "core/result.hpp"

namespace vantage::wire::crtp {

/// Data rate of a radio, with the dongle's number.
enum class DataRate : std::uint8_t { k250Kbps = 0, k1Mbps = 1, k2Mbps = 2 };

/// Address of a vehicle on the air.
struct RadioAddress {
  int channel = 80;  ///< in [0, 125]; 2400 MHz + channel
  DataRate rate = DataRate::k2Mbps;
  std::array<std::uint8_t, 5> address{0xE7, 0xE7, 0xE7, 0xE7, 0xE7};  ///< most significant first
  friend bool operator==(const RadioAddress&, const RadioAddress&) = default;
};
/// Vehicle on a radio.
struct RadioUri {
  int dongle = 0;  ///< index among the connected dongles
  RadioAddress address;
};
/// Firmware on a computer, or a relay.
struct UdpUri {
  std::string host;
  int port = 0;
};
using LinkUri = std::variant<RadioUri, UdpUri>;

/// Parses radio://DONGLE/CHANNEL/250K|1M|2M/ADDRESS or udp://HOST:PORT. Every part is required, so
/// that no vehicle is selected by default values. Error: states the URI, the wrong part and its
/// rule.
Result<LinkUri> parse_link_uri(std::string_view text);

}  // namespace vantage::wire::crtp
