#pragma once

#include <optional>
#include <string>

#include "core/time.hpp"
#include "sim/firmware/firmware_sensors.hpp"
#include "sim/firmware/multirotor.hpp"

namespace vantage::sim {

/// What firmware asks of its motors.
struct MotorCommand {
  Throttles throttles{};
};

/// The simulator's end of the line to the firmware of one autopilot: sensors there, motors back.
/// Used by one thread.
class FirmwareLink {
 public:
  FirmwareLink() = default;
  virtual ~FirmwareLink() = default;
  FirmwareLink(const FirmwareLink&) = delete;
  FirmwareLink& operator=(const FirmwareLink&) = delete;
  FirmwareLink(FirmwareLink&&) = delete;
  FirmwareLink& operator=(FirmwareLink&&) = delete;

  /// How often the firmware wants its sensors.
  [[nodiscard]] virtual Duration period() const = 0;
  /// The firmware's clock stands between sensors and motors.
  [[nodiscard]] virtual bool is_lockstep() const = 0;
  /// Hands the firmware what its sensors say now; false while nobody is there to be told.
  virtual bool send(const FirmwareSensors& sensors) = 0;
  /// The next motor command, waiting at most `timeout`; nullopt when none came.
  virtual std::optional<MotorCommand> receive(Duration timeout) = 0;
};

}  // namespace vantage::sim
