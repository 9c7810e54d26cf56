#pragma once

#include <cstdint>
#include <string>

#include "core/time.hpp"
#include "sim/rover/rover_emulator.hpp"
#include "sim/vehicle_socket.hpp"

namespace vantage::sim {

/// An emulated rover on a UDP socket, where its driver's URL expects it: it waits for a driver that
/// speaks first (udpout://HOST:PORT), and speaks to one that waits (udp://[HOST]:PORT).
class RoverEndpoint {
 public:
  /// @throws StartupError as VehicleSocket does.
  RoverEndpoint(const RoverEmulatorSpec& spec, const std::string& driver_url, Time start);

  /// Takes what has arrived, drives on to `now`, sends what became due. Never waits.
  void run_to(Time now);

  [[nodiscard]] RoverEmulator& emulator() { return emulator_; }
  [[nodiscard]] const RoverEmulator& emulator() const { return emulator_; }
  [[nodiscard]] std::int64_t send_errors() const { return socket_.send_errors(); }

 private:
  RoverEmulator emulator_;
  VehicleSocket socket_;
};

}  // namespace vantage::sim
