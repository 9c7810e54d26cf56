#include "tools/view/peer_sockets.hpp"

#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

namespace vantage::tools {
namespace {

ConnectionTable::Peer peer_of(const sockaddr_storage& address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  std::uint16_t port = 0;
  if (address.ss_family == AF_INET) {
    sockaddr_in in{};
    std::memcpy(&in, &address, sizeof in);
    port = ntohs(in.sin_port);
    ::inet_ntop(AF_INET, &in.sin_addr, text.data(), text.size());
  } else if (address.ss_family == AF_INET6) {
    sockaddr_in6 in{};
    std::memcpy(&in, &address, sizeof in);
    port = ntohs(in.sin6_port);
    ::inet_ntop(AF_INET6, &in.sin6_addr, text.data(), text.size());
  }
  return {text.data(), port};
}

}  // namespace

std::optional<ConnectionTable::Peer> peer_at(int descriptor, int port) {
  sockaddr_storage own{};
  sockaddr_storage other{};
  socklen_t own_size = sizeof own;
  socklen_t other_size = sizeof other;
  const bool is_connected =
      ::getsockname(descriptor, reinterpret_cast<sockaddr*>(&own), &own_size) == 0 &&
      ::getpeername(descriptor, reinterpret_cast<sockaddr*>(&other), &other_size) == 0;
  return is_connected && peer_of(own).port == port ? std::optional(peer_of(other)) : std::nullopt;
}

std::map<ConnectionTable::Peer, int> connections_to(int port) {
  std::map<ConnectionTable::Peer, int> out;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    const int descriptor = std::atoi(entry.path().filename().c_str());
    if (auto peer = peer_at(descriptor, port)) {
      out.emplace(std::move(*peer), descriptor);
    }
  }
  return out;
}

}  // namespace vantage::tools
