#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <netinet/in.h>

#include "core/time.hpp"

namespace vantage::sim {

/// A simulated vehicle's end of the UDP wire to its driver, whatever is spoken on it. Never waits.
class VehicleSocket {
 public:
  /// @param driver_url  how the driver is told to reach its vehicle: at udp://[HOST]:PORT it waits
  ///                    to be spoken to (this host when there is none), at udpout://HOST:PORT it
  ///                    speaks first, to us
  /// @throws StartupError for another URL, or a port that cannot be had.
  explicit VehicleSocket(const std::string& driver_url);
  ~VehicleSocket();
  VehicleSocket(const VehicleSocket&) = delete;
  VehicleSocket& operator=(const VehicleSocket&) = delete;
  VehicleSocket(VehicleSocket&&) = delete;
  VehicleSocket& operator=(VehicleSocket&&) = delete;

  /// Hands over each datagram that has arrived, as take(bytes, arrival): the arrival is by the
  /// kernel's word, in the machine's clock. At most kReadsMax: a flood must not stop the vehicle.
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

  /// Datagrams that could not be sent. A driver that does not listen yet is not counted.
  [[nodiscard]] std::int64_t send_errors() const { return send_errors_; }

 private:
  static constexpr int kReadsMax = 64;

  struct Datagram {
    std::span<const std::uint8_t> bytes;  ///< until the next one is read
    Time arrival{};
  };
  std::optional<Datagram> read();

  int fd_ = -1;
  std::optional<sockaddr_in> driver_;
  std::int64_t send_errors_ = 0;
  std::array<std::uint8_t, 2048> buffer_{};
};

}  // namespace vantage::sim
