#pragma once

#include <cstdint>
#include <string>

#include "core/time.hpp"
#include "sim/rover/rover_emulator.hpp"
#include "sim/vehicle_socket.hpp"

namespace vantage::sim {

/// Emulated rover on a UDP socket at the address that its driver's URL expects. It waits for a
/// driver that sends first (udpout://HOST:PORT), and sends first to a driver that listens
/// (udp://[HOST]:PORT).
class RoverEndpoint {
 public:
  /// @throws StartupError as VehicleSocket does.
  RoverEndpoint(const RoverEmulatorSpec& spec, const std::string& driver_url, Time start);

  /// Simulates the motion until `now`, processes the received datagrams and sends telemetry if it
  /// is due. Never blocks.
  void run_to(Time now);

  [[nodiscard]] RoverEmulator& emulator() { return emulator_; }
  [[nodiscard]] const RoverEmulator& emulator() const { return emulator_; }
  [[nodiscard]] std::int64_t send_errors() const { return socket_.send_errors(); }

 private:
  RoverEmulator emulator_;
  VehicleSocket socket_;
};

}  // namespace vantage::sim
