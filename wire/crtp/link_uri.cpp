#include "wire/crtp/link_uri.hpp"

#include <charconv>
#include <optional>
#include <vector>

#include "core/address.hpp"

namespace vantage::wire::crtp {
namespace {

constexpr int kDonglesMax = 16;
constexpr int kChannelMax = 125;
constexpr std::string_view kRadio = "radio://";
constexpr std::string_view kUdp = "udp://";

std::optional<std::uint64_t> number(std::string_view text, int base) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  const bool is_whole = error == std::errc() && end == text.data() + text.size() && !text.empty();
  return is_whole ? std::optional(value) : std::nullopt;
}

Result<LinkUri> refuse(std::string_view uri, const std::string& why) {
  return Error{std::string(uri) + ": " + why};
}

std::vector<std::string_view> parts_of(std::string_view text) {
  std::vector<std::string_view> out;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('/', at), text.size());
    out.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

Result<LinkUri> parse_radio(std::string_view uri) {
  const std::vector<std::string_view> parts = parts_of(uri.substr(kRadio.size()));
  if (parts.size() != 4) {
    return refuse(
        uri, "expected radio://DONGLE/CHANNEL/RATE/ADDRESS, such as radio://0/80/2M/E7E7E7E701");
  }
  RadioUri out;
  const auto dongle = number(parts[0], 10);
  if (!dongle || *dongle >= kDonglesMax) {
    return refuse(uri, "the dongle must be a number from 0 to 15");
  }
  out.dongle = static_cast<int>(*dongle);
  const auto channel = number(parts[1], 10);
  if (!channel || *channel > kChannelMax) {
    return refuse(uri, "the channel must be a number from 0 to 125");
  }
  out.address.channel = static_cast<int>(*channel);
  if (parts[2] == "250K") {
    out.address.rate = DataRate::k250Kbps;
  } else if (parts[2] == "1M") {
    out.address.rate = DataRate::k1Mbps;
  } else if (parts[2] == "2M") {
    out.address.rate = DataRate::k2Mbps;
  } else {
    return refuse(uri, "the data rate must be 250K, 1M or 2M");
  }
  const auto address = number(parts[3], 16);
  if (!address || parts[3].size() != 10) {
    return refuse(uri, "the address must have 10 hexadecimal digits");
  }
  for (std::size_t i = 0; i < out.address.address.size(); ++i) {
    out.address.address[i] = static_cast<std::uint8_t>(*address >> (8U * (4 - i)));
  }
  return LinkUri(out);
}

}  // namespace

Result<LinkUri> parse_link_uri(std::string_view text) {
  if (text.starts_with(kRadio)) {
    return parse_radio(text);
  }
  if (!text.starts_with(kUdp)) {
    return refuse(text, "must begin with radio:// or udp://");
  }
  const Result<HostAndPort> address = split_address(text.substr(kUdp.size()));
  if (!address.ok()) {
    return refuse(text, address.error().message);
  }
  if (address.value().host.empty()) {
    return refuse(text, "needs the host of the vehicle, such as udp://127.0.0.1:19850");
  }
  return LinkUri(UdpUri{address.value().host, address.value().port});
}

}  // namespace vantage::wire::crtp
