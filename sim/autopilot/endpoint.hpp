#pragma once

#include <cstdint>
#include <string>

#include "core/time.hpp"
#include "sim/autopilot/autopilot_emulator.hpp"
#include "sim/vehicle_socket.hpp"

namespace vantage::sim {

/// An emulated autopilot on a UDP socket, where its driver's URL expects it: it speaks to a driver
/// that waits (udp://[HOST]:PORT), and waits for one that speaks first (udpout://HOST:PORT).
class AutopilotEndpoint {
 public:
  /// @throws StartupError as VehicleSocket does.
  AutopilotEndpoint(const AutopilotEmulatorSpec& spec, const std::string& driver_url, Time boot);

  /// Takes what has arrived, flies on to `now`, sends what became due. Never waits.
  void run_to(Time now);

  [[nodiscard]] AutopilotEmulator& emulator() { return emulator_; }
  [[nodiscard]] const AutopilotEmulator& emulator() const { return emulator_; }
  [[nodiscard]] std::int64_t send_errors() const { return socket_.send_errors(); }

 private:
  AutopilotEmulator emulator_;
  VehicleSocket socket_;
};

}  // namespace vantage::sim
