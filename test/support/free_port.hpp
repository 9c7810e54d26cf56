#pragma once

#include <cstdint>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace vantage::test {

inline bool is_port_free(int kind, int port) {
  const int fd = socket(AF_INET, kind, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  const bool is_bound = bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  close(fd);
  return is_bound;
}

/// Returns a port of the loopback that is unused for TCP and UDP and outside the kernel's ephemeral
/// range (32768 and more), so that it stays free. The first port depends on the process id; each
/// call searches from the port after the last result.
inline int free_port() {
  static int next = 12'000 + getpid() % 20'000;
  while (!is_port_free(SOCK_STREAM, next) || !is_port_free(SOCK_DGRAM, next)) {
    ++next;
  }
  return next++;
}

}  // namespace vantage::test
