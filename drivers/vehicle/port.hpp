#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

/// One end of a wire: bytes out, bytes in, never waiting. What goes wrong is counted and mended.
class Port {
 public:
  Port() = default;
  virtual ~Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  Port(Port&&) = delete;
  Port& operator=(Port&&) = delete;

  /// Whether what read() gives are whole datagrams.
  [[nodiscard]] virtual bool is_datagram() const = 0;
  /// What has arrived, into `buffer`; how many bytes, 0 when nothing has.
  virtual std::size_t read(std::span<std::uint8_t> buffer, Time now) = 0;
  /// The bytes read last came from the vehicle: from now on their sender alone is listened to, and
  /// answered, until it has been silent for three seconds.
  virtual void accept(Time /*now*/) {}
  /// Sends one message whole or not at all.
  virtual void write(std::span<const std::uint8_t> message, Time now) = 0;
  [[nodiscard]] virtual std::vector<models::NamedCount> counters() const = 0;
};

/// Opens a port by URL:
///   udp://[HOST]:PORT      waits there for the vehicle and answers the sender that was accepted
///   udpout://HOST:PORT     speaks first
///   serial:DEVICE[:BAUD]   921600 baud without one, 230400 at least; opened again when it goes
///                          away
/// @throws StartupError saying what is wrong with the URL, the address or the device's settings. A
/// serial device that is not there yet is waited for.
std::unique_ptr<Port> open_port(const std::string& url);

std::unique_ptr<Port> open_udp_port(const std::string& host, std::uint16_t port, bool speaks_first);
std::unique_ptr<Port> open_serial_port(const std::string& device, int baud);

}  // namespace vantage::drivers
