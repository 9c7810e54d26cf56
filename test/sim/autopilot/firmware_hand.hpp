#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "core/child.hpp"
#include "drivers/vehicle/port.hpp"
#include "sim/firmware/firmware_link.hpp"
#include "sim/firmware/firmware_sensors.hpp"
#include "sim/firmware/multirotor.hpp"
#include "test/sim/autopilot/hand.hpp"

namespace vantage::test {

/// A hand at real firmware that flies a simulated body, in lockstep and in the body's own time: it
/// does not matter how long the machine takes, as long as the firmware does not run after it.
class FirmwareHand : public Hand {
 public:
  /// Starts the firmware as `vantage up` would, in `folder`. Instance 0 of its ports.
  /// @throws StartupError when it cannot be.
  FirmwareHand(models::AutopilotDialect spoken, const std::string& binary,
               const std::string& folder, std::uint64_t seed);

  [[nodiscard]] Body body() const override;
  /// As cameras of some milliseconds' latency do.
  [[nodiscard]] Body seen() const override { return seen_; }
  /// As it was started.
  [[nodiscard]] const std::string& command_line() const { return command_line_; }

 protected:
  void transmit(std::span<const std::uint8_t> bytes) override;
  void pass() override;

 private:
  void step();

  std::unique_ptr<sim::FirmwareLink> link_;
  std::unique_ptr<drivers::Port> port_;
  sim::Multirotor body_;
  sim::SensorBoard board_;
  sim::Throttles throttles_{};
  Duration elapsed_{0};  ///< of the body's time
  Duration elapsed_at_start_{0};
  bool has_answered_ = false;
  int unanswered_ = 0;  ///< one after the other
  Body seen_;
  std::int64_t begun_ns_;
  std::string command_line_;
  std::optional<Child> child_;
  std::array<std::uint8_t, 2048> buffer_{};
};

}  // namespace vantage::test
