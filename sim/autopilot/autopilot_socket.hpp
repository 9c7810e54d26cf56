#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <netinet/in.h>

#include "core/time.hpp"

namespace vantage::sim {

/// The vehicle's end of a UDP wire to its driver. Never waits.
class AutopilotSocket {
 public:
  /// @param driver_url  how the driver is told to reach its autopilot: at udp://[HOST]:PORT it
  /// waits
  ///                    to be spoken to (this host when there is none), at udpout://HOST:PORT it
  ///                    speaks first, to us
  /// @throws StartupError for another URL, or a port that cannot be had.
  explicit AutopilotSocket(const std::string& driver_url);
  ~AutopilotSocket();
  AutopilotSocket(const AutopilotSocket&) = delete;
  AutopilotSocket& operator=(const AutopilotSocket&) = delete;
  AutopilotSocket(AutopilotSocket&&) = delete;
  AutopilotSocket& operator=(AutopilotSocket&&) = delete;

  struct Datagram {
    std::size_t bytes = 0;
    Time arrival{};  ///< by the kernel's word, in the machine's clock
  };
  /// The next datagram, into `buffer`; nullopt when there is none.
  std::optional<Datagram> read(std::span<std::uint8_t> buffer);
  void write(std::span<const std::uint8_t> datagram);

  /// Datagrams that could not be sent. A driver that does not listen yet is not counted.
  [[nodiscard]] std::int64_t send_errors() const { return send_errors_; }

 private:
  int fd_ = -1;
  std::optional<sockaddr_in> driver_;
  std::int64_t send_errors_ = 0;
};

}  // namespace vantage::sim
