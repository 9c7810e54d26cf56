#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

/// Non-blocking connection for bytes in both directions. Errors are counted, and a lost connection
/// is restored.
class Port {
 public:
  Port() = default;
  virtual ~Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  Port(Port&&) = delete;
  Port& operator=(Port&&) = delete;

  /// True if read() returns complete datagrams.
  [[nodiscard]] virtual bool is_datagram() const = 0;
  /// Reads received bytes into `buffer`. Returns their number; 0 if there are none.
  virtual std::size_t read(std::span<std::uint8_t> buffer, Time now) = 0;
  /// Reports that the last bytes were sent by the vehicle. From now on only the sender of these
  /// bytes is read and answered, until it has sent nothing for three seconds.
  virtual void accept(Time /*now*/) {}
  /// Sends one message completely or not at all.
  virtual void write(std::span<const std::uint8_t> message, Time now) = 0;
  [[nodiscard]] virtual std::vector<models::NamedCount> counters() const = 0;
};

/// Opens a port by URL:
///   udp://[HOST]:PORT      receives at this address and answers the accepted sender
///   udpout://HOST:PORT     sends first
///   serial:DEVICE[:BAUD]   default 921600 baud, at least 230400; reopened after a loss
/// @throws StartupError that names the fault in the URL, the address or the device's settings. A
/// serial device that does not exist yet is opened later.
std::unique_ptr<Port> open_port(const std::string& url);

std::unique_ptr<Port> open_udp_port(const std::string& host, std::uint16_t port, bool sends_first);
std::unique_ptr<Port> open_serial_port(const std::string& device, int baud);

}  // namespace vantage::drivers
