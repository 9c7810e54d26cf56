#include <cerrno>
#include <optional>
#include <system_error>

#include <sys/socket.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/check.hpp"
#include "drivers/vehicle/port.hpp"
#include "models/exchange/counts.hpp"

namespace vantage::drivers {
namespace {

constexpr Duration kSilence = std::chrono::seconds(3);

std::string reason() { return std::system_category().message(errno); }

bool is_same(const sockaddr_in& a, const sockaddr_in& b) {
  return a.sin_port == b.sin_port && a.sin_addr.s_addr == b.sin_addr.s_addr;
}

class UdpPort : public Port {
 public:
  UdpPort(const std::string& host, std::uint16_t port, bool sends_first)
      : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
    if (fd_ < 0) {
      throw StartupError("cannot create a UDP socket: " + reason());
    }
    try {
      const sockaddr_in address =
          host.empty() ? address_of(INADDR_ANY, port) : require_host(host, port);
      if (sends_first) {
        peer_ = address;
        is_peer_fixed_ = true;
      } else if (bind(fd_, as_sockaddr(address), sizeof address) != 0) {
        throw StartupError("UDP port " + std::to_string(port) + ": " + reason());
      }
    } catch (...) {
      close(fd_);
      throw;
    }
  }
  ~UdpPort() override { close(fd_); }
  UdpPort(const UdpPort&) = delete;
  UdpPort& operator=(const UdpPort&) = delete;
  UdpPort(UdpPort&&) = delete;
  UdpPort& operator=(UdpPort&&) = delete;

  [[nodiscard]] bool is_datagram() const override { return true; }

  std::size_t read(std::span<std::uint8_t> buffer, Time now) override {
    if (peer_ && !is_peer_fixed_ && now - accepted_ > kSilence) {
      disconnect();
    }
    while (true) {
      sockaddr_in from{};
      socklen_t size = sizeof from;
      const ssize_t got =
          recvfrom(fd_, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
      if (got < 0) {
        if (errno == EINTR || errno == ECONNREFUSED) {
          continue;  // the error refers to an earlier datagram
        }
        return 0;
      }
      if (peer_ && !is_same(*peer_, from)) {  // datagram received before the socket was connected
        ++strangers_;
        continue;
      }
      sender_ = from;
      if (got > 0) {
        return static_cast<std::size_t>(got);
      }
    }
  }

  void accept(Time now) override {
    accepted_ = now;
    if (peer_ || !sender_) {
      return;
    }
    // From now on the kernel drops all datagrams of other senders.
    if (connect(fd_, as_sockaddr(*sender_), sizeof *sender_) == 0) {
      peer_ = sender_;
    } else {
      ++send_errors_;
    }
  }

  void write(std::span<const std::uint8_t> message, Time) override {
    if (!peer_) {
      return;  // no datagram of the vehicle was received yet
    }
    const ssize_t sent =
        sendto(fd_, message.data(), message.size(), 0, as_sockaddr(*peer_), sizeof *peer_);
    if (sent != static_cast<ssize_t>(message.size())) {
      ++send_errors_;
    }
  }

  [[nodiscard]] std::vector<models::NamedCount> counters() const override {
    return models::nonzero({{"port.send_errors", send_errors_}, {"port.strangers", strangers_}});
  }

 private:
  void disconnect() {
    sockaddr none{};
    none.sa_family = AF_UNSPEC;
    connect(fd_, &none, sizeof none);
    peer_.reset();
  }

  int fd_;
  std::optional<sockaddr_in> sender_;  ///< sender of the last datagram
  std::optional<sockaddr_in> peer_;    ///< address of the vehicle
  bool is_peer_fixed_ = false;
  Time accepted_{};
  std::int64_t send_errors_ = 0;
  std::int64_t strangers_ = 0;
};

}  // namespace

std::unique_ptr<Port> open_udp_port(const std::string& host, std::uint16_t port, bool sends_first) {
  return std::make_unique<UdpPort>(host, port, sends_first);
}

}  // namespace vantage::drivers
