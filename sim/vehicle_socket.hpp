#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <netinet/in.h>

#include "core/time.hpp"

namespace vantage::sim {

/// Simulated vehicle's end of the UDP connection to its driver, for any protocol. It never blocks.
class VehicleSocket {
 public:
  /// @param driver_url  URL by which the driver reaches its vehicle. With udp://[HOST]:PORT the
  ///                    driver listens there (default: this host) and the vehicle sends first; with
  ///                    udpout://HOST:PORT the driver sends first, to this socket
  /// @throws StartupError for another URL, or if the port cannot be opened.
  explicit VehicleSocket(const std::string& driver_url);
  ~VehicleSocket();
  VehicleSocket(const VehicleSocket&) = delete;
  VehicleSocket& operator=(const VehicleSocket&) = delete;
  VehicleSocket(VehicleSocket&&) = delete;
  VehicleSocket& operator=(VehicleSocket&&) = delete;

  /// Calls take(bytes, arrival) for each received datagram; arrival is the kernel's time stamp by
  /// the machine's clock. Reads at most kReadsMax datagrams, so that a flood of datagrams cannot
  /// block the vehicle.
  template <class Take>
  void read_each(const Take& take) {
    for (int i = 0; i < kReadsMax; ++i) {
      const std::optional<Datagram> datagram = read();
      if (!datagram) {
        break;
      }
      take(datagram->bytes, datagram->arrival);
    }
  }
  void write(std::span<const std::uint8_t> datagram);

  /// Returns the number of datagrams that could not be sent. Datagrams to a driver that does not
  /// listen yet do not count.
  [[nodiscard]] std::int64_t send_errors() const { return send_errors_; }

 private:
  static constexpr int kReadsMax = 64;

  struct Datagram {
    std::span<const std::uint8_t> bytes;  ///< valid until the next read
    Time arrival{};
  };
  std::optional<Datagram> read();

  int fd_ = -1;
  std::optional<sockaddr_in> driver_;
  std::int64_t send_errors_ = 0;
  std::array<std::uint8_t, 2048> buffer_{};
};

}  // namespace vantage::sim
