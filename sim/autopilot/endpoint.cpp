#include "sim/autopilot/endpoint.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <system_error>

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/check.hpp"

namespace vantage::sim {
namespace {

constexpr int kReadsMax = 64;

sockaddr_in read_address(const std::string& url, const std::string& text) {
  const std::size_t colon = text.rfind(':');
  std::uint16_t port = 0;
  const char* const end = text.data() + text.size();
  if (colon == std::string::npos ||
      std::from_chars(text.data() + colon + 1, end, port).ptr != end || port == 0) {
    throw StartupError(url + ": a port is expected after the last ':'");
  }
  const std::string host = text.substr(0, colon);
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_port = htons(port);
  const bool is_anywhere = host.empty() || host == "0.0.0.0" || host == "localhost";
  if (inet_pton(AF_INET, is_anywhere ? "127.0.0.1" : host.c_str(), &out.sin_addr) != 1) {
    throw StartupError(url + ": a simulated autopilot needs an address in numbers");
  }
  return out;
}

/// The C API's word for an address of any family.
const sockaddr* as_sockaddr(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

}  // namespace

AutopilotEndpoint::AutopilotEndpoint(const AutopilotEmulatorSpec& spec,
                                     const std::string& driver_url, Time boot)
    : emulator_(spec, boot), fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
  if (fd_ < 0) {
    throw StartupError("cannot make a UDP socket: " + std::system_category().message(errno));
  }
  try {
    if (driver_url.starts_with("udp://")) {
      const sockaddr_in driver = read_address(driver_url, driver_url.substr(6));
      has_peer_ = true;
      peer_address_ = driver.sin_addr.s_addr;
      peer_port_ = driver.sin_port;
    } else if (driver_url.starts_with("udpout://")) {
      const sockaddr_in own = read_address(driver_url, driver_url.substr(9));
      if (bind(fd_, as_sockaddr(own), sizeof own) != 0) {
        throw StartupError(driver_url + ": " + std::system_category().message(errno));
      }
    } else {
      throw StartupError(driver_url + ": a simulated autopilot is reached by UDP");
    }
  } catch (...) {
    close(fd_);
    throw;
  }
}

AutopilotEndpoint::~AutopilotEndpoint() { close(fd_); }

void AutopilotEndpoint::run_to(Time now) {
  emulator_.advance_to(now);
  std::array<std::uint8_t, 2048> buffer{};
  for (int i = 0; i < kReadsMax; ++i) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t got =
        recvfrom(fd_, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (got < 0 && (errno == ECONNREFUSED || errno == EINTR)) {
      continue;  // nobody was there for an earlier datagram
    }
    if (got < 0) {
      break;
    }
    has_peer_ = true;
    peer_address_ = from.sin_addr.s_addr;
    peer_port_ = from.sin_port;
    emulator_.receive({buffer.data(), static_cast<std::size_t>(got)}, now);
  }
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = peer_address_;
  to.sin_port = peer_port_;
  for (const auto& datagram : emulator_.take_output()) {
    if (has_peer_ && sendto(fd_, datagram.data(), datagram.size(), 0, as_sockaddr(to), sizeof to) !=
                         static_cast<ssize_t>(datagram.size())) {
      ++send_errors_;
    }
  }
}

}  // namespace vantage::sim
