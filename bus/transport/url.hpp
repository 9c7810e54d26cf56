#pragma once

#include <map>
#include <string>

namespace vantage::bus {

inline constexpr const char* kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0";

/// The parts of "scheme://target?name=value&name=value".
struct Url {
  std::string scheme;
  std::string target;
  std::map<std::string, std::string> options;
};

/// @throws StartupError when "://" is missing, or an option is not name=value or is given twice.
Url parse_url(const std::string& url);

/// Returns `url`; if it is empty, $LCM_DEFAULT_URL or else LCM's default.
std::string url_or_default(const std::string& url);

/// Returns a udpm:// URL with the option added, unless it has one of that name; returns other URLs
/// unchanged.
/// @throws StartupError as parse_url.
std::string with_udpm_option(const std::string& url, const std::string& name,
                             const std::string& value);

/// The content of a udpm:// URL, with LCM's defaults for missing parts.
struct UdpmAddress {
  std::string group = "239.255.76.67";
  int port = 7667;
  int ttl = 0;  ///< hops; 0: this host only; 1: this network
  int recv_buf_bytes = 4 << 20;
  int message_bytes_max = 4 << 20;
  /// Network card to receive and send on, by name ("eth1") or by its own IPv4 address; empty: the
  /// card of the route to the group.
  std::string interface;
};

/// Options: ttl, recv_buf_size and max_message_size (bytes), interface.
/// @throws StartupError for an address that is not multicast, a number out of range, an invalid
///         interface or an unknown option.
UdpmAddress parse_udpm(const Url& url);

}  // namespace vantage::bus
