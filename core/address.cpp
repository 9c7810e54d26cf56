#include "core/address.hpp"

#include <charconv>
#include <cstdint>
#include <cstring>

#include <netdb.h>

#include "core/check.hpp"

namespace vantage {

Result<HostAndPort> split_address(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  int port = 0;
  if (colon != std::string_view::npos) {
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data() + colon + 1, last, port);
    if (error == std::errc() && end == last && port >= 1 && port <= 65535) {
      return HostAndPort{std::string(text.substr(0, colon)), port};
    }
  }
  return Error{"a port from 1 to 65535 is expected after the last ':'"};
}

Result<sockaddr_in> find_host(const std::string& host, int port) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (error != 0) {
    return Error{"no such host: " + host + " (" + gai_strerror(error) + ")"};
  }
  sockaddr_in out{};
  std::memcpy(&out, found->ai_addr, sizeof out);
  freeaddrinfo(found);
  out.sin_port = htons(static_cast<std::uint16_t>(port));
  return out;
}

sockaddr_in require_host(const std::string& host, int port) {
  const Result<sockaddr_in> found = find_host(host, port);
  if (!found.ok()) {
    throw StartupError(found.error().message);
  }
  return found.value();
}

sockaddr_in address_of(in_addr_t host, int port) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_port = htons(static_cast<std::uint16_t>(port));
  out.sin_addr.s_addr = htonl(host);
  return out;
}

}  // namespace vantage
