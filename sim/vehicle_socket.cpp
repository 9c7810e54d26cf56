#include "sim/vehicle_socket.hpp"

#include <cerrno>
#include <cstring>
#include <ctime>
#include <system_error>

#include <sys/socket.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/check.hpp"
#include "core/reception.hpp"

namespace vantage::sim {
namespace {

sockaddr_in address_in(const std::string& url, std::size_t scheme_length) {
  const Result<HostAndPort> parts = split_address(url.substr(scheme_length));
  if (!parts.ok()) {
    throw StartupError(url + ": " + parts.error().message);
  }
  const auto& [host, port] = parts.value();
  return host.empty() || host == "0.0.0.0" ? address_of(INADDR_LOOPBACK, port)
                                           : require_host(host, port);
}

/// Returns the kernel's time stamp of the arrival; the present time if the kernel sets none.
Time arrival_of(Reception<timespec>& reception) {
  timespec stamp{};
  if (const auto received = reception.ancillary(SCM_TIMESTAMPNS)) {
    stamp = *received;
  } else {
    clock_gettime(CLOCK_REALTIME, &stamp);
  }
  return from_utime(stamp.tv_sec * 1'000'000 + stamp.tv_nsec / 1'000);
}

}  // namespace

VehicleSocket::VehicleSocket(const std::string& driver_url) {
  constexpr const char* kDriverWaits = "udp://";
  constexpr const char* kDriverSpeaks = "udpout://";
  const bool sends_first = driver_url.starts_with(kDriverWaits);
  if (!sends_first && !driver_url.starts_with(kDriverSpeaks)) {
    throw StartupError("vehicle '" + driver_url +
                       "': a simulated vehicle needs a udp:// or udpout:// url");
  }
  const sockaddr_in address =
      address_in(driver_url, std::strlen(sends_first ? kDriverWaits : kDriverSpeaks));
  fd_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd_ < 0) {
    throw StartupError("cannot create a UDP socket: " + std::system_category().message(errno));
  }
  const int on = 1;
  // Time stamps are optional: emulated and sandboxed kernels may not support them.
  static_cast<void>(setsockopt(fd_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on));
  if (sends_first) {
    driver_ = address;
  } else if (bind(fd_, as_sockaddr(address), sizeof address) != 0) {
    const std::string why = std::system_category().message(errno);
    close(fd_);
    throw StartupError(driver_url + ": " + why);
  }
}

VehicleSocket::~VehicleSocket() { close(fd_); }

std::optional<VehicleSocket::Datagram> VehicleSocket::read() {
  while (true) {
    Reception<timespec> reception(fd_, buffer_, 0);
    if (reception.size() < 0 && (errno == EINTR || errno == ECONNREFUSED)) {
      continue;  // ECONNREFUSED refers to an earlier datagram
    }
    if (reception.size() < 0) {
      return std::nullopt;
    }
    driver_ = reception.from();
    if (reception.size() > 0) {
      return Datagram{{buffer_.data(), static_cast<std::size_t>(reception.size())},
                      arrival_of(reception)};
    }
  }
}

void VehicleSocket::write(std::span<const std::uint8_t> datagram) {
  if (!driver_) {
    return;
  }
  const ssize_t sent =
      sendto(fd_, datagram.data(), datagram.size(), 0, as_sockaddr(*driver_), sizeof *driver_);
  if (sent != static_cast<ssize_t>(datagram.size()) && errno != ECONNREFUSED) {
    ++send_errors_;
  }
}

}  // namespace vantage::sim
