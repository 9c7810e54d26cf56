#pragma once

#include <map>
#include <string>

namespace vantage::bus {

inline constexpr const char* kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0";

/// "scheme://target?name=value&name=value", taken apart.
struct Url {
  std::string scheme;
  std::string target;
  std::map<std::string, std::string> options;
};

/// @throws StartupError when there is no "://", or an option is not name=value or is given twice.
Url parse_url(const std::string& url);

/// What udpm:// says, with LCM's defaults for what it leaves out.
struct UdpmAddress {
  std::string group = "239.255.76.67";
  int port = 7667;
  int ttl = 0;  ///< 0: this host only; 1: this network
  int recv_buf_bytes = 4 << 20;
  int message_bytes_max = 4 << 20;
};

/// Options: ttl, recv_buf_size and max_message_size (bytes).
/// @throws StartupError for an address that is not multicast, a number out of range or an unknown
///         option.
UdpmAddress parse_udpm(const Url& url);

}  // namespace vantage::bus
