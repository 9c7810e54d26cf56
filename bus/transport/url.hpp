#pragma once

#include <map>
#include <string>
#include <vector>

namespace vantage::bus {

inline constexpr const char* kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0";

/// Parts of "scheme://target?name=value&name=value".
struct Url {
  std::string scheme;
  std::string target;
  std::map<std::string, std::string> options;
};

/// @throws StartupError when "://" is missing, or an option is not name=value or is given twice.
Url parse_url(const std::string& url);

/// Returns `url`. If it is empty, returns $LCM_DEFAULT_URL or, if that is not set, LCM's default.
std::string url_or_default(const std::string& url);

/// Returns a udpm:// URL with the option added, unless it already has an option with this name.
/// Returns other URLs unchanged.
/// @throws StartupError as parse_url.
std::string with_udpm_option(const std::string& url, const std::string& name,
                             const std::string& value);

/// Host that receives unicast copies.
struct UdpmPeer {
  std::string address;  ///< IPv4
  int port = 0;
  friend bool operator==(const UdpmPeer&, const UdpmPeer&) = default;
};

/// Content of a udpm:// URL, with LCM's defaults for missing parts.
struct UdpmAddress {
  std::string group = "239.255.76.67";
  int port = 7667;
  int ttl = 0;  ///< maximum number of hops; 0: this host only; 1: this network
  int recv_buf_bytes = 4 << 20;
  int message_bytes_max = 4 << 20;
  /// Network card to receive and send on, by name ("eth1") or by its own IPv4 address; empty: the
  /// card of the route to the group.
  std::string interface;
  /// All hosts of the team, if messages leave a host by unicast; see UnicastRelay. This host's own
  /// entry is the address on which it receives.
  std::vector<UdpmPeer> peers;
};

/// Options: ttl, recv_buf_size and max_message_size (bytes), interface,
/// peers (ADDRESS:PORT,ADDRESS:PORT,…).
/// @throws StartupError for an address that is not multicast, a number out of range, an invalid
///         interface or peer, peers together with a ttl above 0 or an
///         interface, or an unknown option.
UdpmAddress parse_udpm(const Url& url);

}  // namespace vantage::bus
