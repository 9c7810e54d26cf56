#pragma once

#include <cstdint>
#include <string>

#include "core/time.hpp"
#include "sim/autopilot/autopilot_emulator.hpp"
#include "sim/vehicle_socket.hpp"

namespace vantage::sim {

/// Emulated autopilot on a UDP socket at the address that its driver's URL expects. It sends first
/// to a driver that listens (udp://[HOST]:PORT), and waits for a driver that sends first
/// (udpout://HOST:PORT).
class AutopilotEndpoint {
 public:
  /// @throws StartupError as VehicleSocket does.
  AutopilotEndpoint(const AutopilotEmulatorSpec& spec, const std::string& driver_url, Time boot);

  /// Receives all datagrams, simulates the flight until `now` and sends the messages that became
  /// due. Never blocks.
  void run_to(Time now);

  [[nodiscard]] AutopilotEmulator& emulator() { return emulator_; }
  [[nodiscard]] const AutopilotEmulator& emulator() const { return emulator_; }
  [[nodiscard]] std::int64_t send_errors() const { return socket_.send_errors(); }

 private:
  AutopilotEmulator emulator_;
  VehicleSocket socket_;
};

}  // namespace vantage::sim
