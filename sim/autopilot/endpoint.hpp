#pragma once

#include <cstdint>
#include <string>

#include "core/time.hpp"
#include "sim/autopilot/autopilot_emulator.hpp"

namespace vantage::sim {

/// An emulated autopilot on a UDP socket, where its driver's URL expects it: it speaks to a driver
/// that waits (udp://[HOST]:PORT), and waits for one that speaks first (udpout://HOST:PORT).
class AutopilotEndpoint {
 public:
  /// @throws StartupError for a URL that is not UDP, or a port that cannot be had.
  AutopilotEndpoint(const AutopilotEmulatorSpec& spec, const std::string& driver_url, Time boot);
  ~AutopilotEndpoint();
  AutopilotEndpoint(const AutopilotEndpoint&) = delete;
  AutopilotEndpoint& operator=(const AutopilotEndpoint&) = delete;
  AutopilotEndpoint(AutopilotEndpoint&&) = delete;
  AutopilotEndpoint& operator=(AutopilotEndpoint&&) = delete;

  /// Takes what has arrived, flies on to `now`, sends what became due. Never waits.
  void run_to(Time now);

  [[nodiscard]] AutopilotEmulator& emulator() { return emulator_; }
  [[nodiscard]] const AutopilotEmulator& emulator() const { return emulator_; }
  [[nodiscard]] std::int64_t send_errors() const { return send_errors_; }

 private:
  AutopilotEmulator emulator_;
  int fd_;
  bool has_peer_ = false;
  std::uint32_t peer_address_ = 0;  ///< network order, as the port
  std::uint16_t peer_port_ = 0;
  std::int64_t send_errors_ = 0;
};

}  // namespace vantage::sim
