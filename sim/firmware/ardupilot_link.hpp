#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <netinet/in.h>

#include "sim/firmware/firmware_link.hpp"

namespace vantage::sim {

/// Link to ArduPilot's firmware through its JSON physics back end over UDP (wire/sitl). The
/// firmware sends first, and each of its datagrams is answered once.
class ArdupilotLink : public FirmwareLink {
 public:
  /// Listens at 127.0.0.1, port 9002 + 10 instance, to which firmware of `instance` sends.
  /// @throws StartupError if the port cannot be opened.
  explicit ArdupilotLink(int instance);
  ~ArdupilotLink() override;

  /// Returns the period for 800 Hz: ArduPilot requires at least 1.8 times its loop rate of 400 Hz
  /// to arm.
  [[nodiscard]] Duration period() const override { return Duration{1'250}; }
  [[nodiscard]] bool is_lockstep() const override { return true; }
  bool send(const FirmwareSensors& sensors) override;
  std::optional<MotorCommand> receive(Duration timeout) override;

 private:
  int fd_ = -1;
  std::optional<sockaddr_in> firmware_;
  bool has_unanswered_ = false;  ///< a datagram of the firmware is not yet answered
  std::array<std::uint8_t, 256> buffer_{};
};

}  // namespace vantage::sim
