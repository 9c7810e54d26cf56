#pragma once

#include <string>
#include <string_view>

#include <netinet/in.h>
#include <sys/socket.h>

#include "core/result.hpp"

namespace vantage {

/// A host, empty where any will do, and a port from 1 to 65535.
struct HostAndPort {
  std::string host;
  int port = 0;
};
/// Parts "HOST:PORT" at its last ':'.
/// Error: "a port from 1 to 65535 is expected after the last ':'".
Result<HostAndPort> split_address(std::string_view text);

/// The IPv4 address of `host`, a name or a number, with `port` in [0, 65535]. Waits for the name
/// service, but not for a number.
/// Error: "no such host: HOST (what the name service says)".
Result<sockaddr_in> find_host(const std::string& host, int port);
/// The same at start-up. @throws StartupError in the words of the Error.
sockaddr_in require_host(const std::string& host, int port);

/// `host` is one of INADDR_ANY, INADDR_LOOPBACK, … or another address in the machine's byte order.
sockaddr_in address_of(in_addr_t host, int port);

/// The C API's word for an address of any family.
inline const sockaddr* as_sockaddr(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

}  // namespace vantage
