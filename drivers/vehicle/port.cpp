#include "drivers/vehicle/port.hpp"

#include <charconv>
#include <optional>

#include "core/address.hpp"
#include "core/check.hpp"

namespace vantage::drivers {
namespace {

std::optional<int> whole_number(const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_whole = error == std::errc() && end == text.data() + text.size();
  return is_whole ? std::optional(value) : std::nullopt;
}

std::unique_ptr<Port> open_udp_url(const std::string& url, const std::string& address,
                                   bool sends_first) {
  const Result<HostAndPort> parts = split_address(address);
  if (!parts.ok()) {
    throw StartupError(url + ": " + parts.error().message);
  }
  const auto& [host, port] = parts.value();
  if (sends_first && host.empty()) {
    throw StartupError(url + ": udpout:// needs a host to send to");
  }
  return open_udp_port(host, static_cast<std::uint16_t>(port), sends_first);
}

}  // namespace

std::unique_ptr<Port> open_port(const std::string& url) {
  const auto after = [&url](const std::string& scheme) -> std::optional<std::string> {
    return url.starts_with(scheme) ? std::optional(url.substr(scheme.size())) : std::nullopt;
  };
  if (const auto address = after("udp://")) {
    return open_udp_url(url, *address, false);
  }
  if (const auto address = after("udpout://")) {
    return open_udp_url(url, *address, true);
  }
  if (const auto device = after("serial:")) {
    constexpr int kBaud = 921'600;
    const std::size_t colon = device->rfind(':');
    if (colon == std::string::npos) {
      return open_serial_port(*device, kBaud);
    }
    const auto baud = whole_number(device->substr(colon + 1));
    if (!baud) {
      throw StartupError(url + ": a baud rate is expected after the last ':'");
    }
    return open_serial_port(device->substr(0, colon), *baud);
  }
  throw StartupError(url +
                     ": expected udp://[HOST]:PORT, udpout://HOST:PORT or serial:DEVICE:BAUD");
}

}  // namespace vantage::drivers
