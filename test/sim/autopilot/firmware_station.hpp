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
#include "test/sim/autopilot/scripted_station.hpp"

namespace vantage::test {

/// A station that connects real firmware to a simulated body. Both run in lockstep in the time of
/// the body, so the speed of the machine does not matter as long as the firmware does not fall
/// behind.
class FirmwareStation : public ScriptedStation {
 public:
  /// Starts the firmware as `vantage up` would, in `folder`, with the ports of instance 0.
  /// @throws StartupError if it cannot be started.
  FirmwareStation(models::AutopilotDialect spoken, const std::string& binary,
                  const std::string& folder, std::uint64_t seed);

  [[nodiscard]] Body body() const override;
  /// Returns the body as seen by cameras with a latency of some milliseconds.
  [[nodiscard]] Body seen() const override { return seen_; }
  /// Returns the command line of the firmware.
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
  Duration elapsed_{0};  ///< simulated time of the body
  Duration elapsed_at_start_{0};
  bool has_answered_ = false;
  int unanswered_ = 0;  ///< number of consecutive sensor samples without an answer
  Body seen_;
  std::int64_t begun_ns_;
  std::string command_line_;
  std::optional<Child> child_;
  std::array<std::uint8_t, 2048> buffer_{};
};

}  // namespace vantage::test
