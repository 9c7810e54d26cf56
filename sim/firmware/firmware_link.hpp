#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/time.hpp"
#include "sim/firmware/firmware_sensors.hpp"
#include "sim/firmware/multirotor.hpp"

namespace vantage::sim {

/// Motor command of the firmware.
struct MotorCommand {
  Throttles throttles{};
};

/// Simulator's end of the link to the firmware of one autopilot: sends sensor values, receives
/// motor commands. Used by one thread.
class FirmwareLink {
 public:
  FirmwareLink() = default;
  virtual ~FirmwareLink() = default;
  FirmwareLink(const FirmwareLink&) = delete;
  FirmwareLink& operator=(const FirmwareLink&) = delete;
  FirmwareLink(FirmwareLink&&) = delete;
  FirmwareLink& operator=(FirmwareLink&&) = delete;

  /// Returns the period at which the firmware expects sensor values.
  [[nodiscard]] virtual Duration period() const = 0;
  /// True if the firmware's clock advances only with sensor messages: the firmware answers each
  /// sensor message with one motor command.
  [[nodiscard]] virtual bool is_lockstep() const = 0;
  /// Sends the sensor values to the firmware; false if no firmware is connected.
  virtual bool send(const FirmwareSensors& sensors) = 0;
  /// Returns the next motor command after at most `timeout`; nullopt if none arrived.
  virtual std::optional<MotorCommand> receive(Duration timeout) = 0;
  /// Returns the number of packets between other programs that the link could not relay.
  [[nodiscard]] virtual std::int64_t dropped() const { return 0; }
};

}  // namespace vantage::sim
