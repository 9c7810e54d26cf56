#pragma once

#include <string>
#include <string_view>

#include <netinet/in.h>
#include <sys/socket.h>

#include "core/result.hpp"

namespace vantage {

/// Host name or address (empty: any host) and port, 1 to 65535.
struct HostAndPort {
  std::string host;
  int port = 0;
};
/// Splits "HOST:PORT" at the last ':'.
/// Error: "a port from 1 to 65535 is expected after the last ':'".
Result<HostAndPort> split_address(std::string_view text);

/// Returns the IPv4 address of `host` (a name or a numeric address) with `port` in [0, 65535].
/// Blocks while the name service resolves a name; a numeric address does not block.
/// Error: "no such host: HOST (message of the name service)".
Result<sockaddr_in> find_host(const std::string& host, int port);
/// As find_host(), at start-up. @throws StartupError with the message of the Error.
sockaddr_in require_host(const std::string& host, int port);

/// Returns the socket address of `host` and `port`. `host` is INADDR_ANY, INADDR_LOOPBACK or
/// another address in host byte order.
sockaddr_in address_of(in_addr_t host, int port);

/// Casts to the address type of the C API.
inline const sockaddr* as_sockaddr(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

}  // namespace vantage
