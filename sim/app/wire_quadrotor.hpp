#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/latency_record.hpp"
#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"
#include "sim/app/wire_vehicle.hpp"
#include "sim/autopilot/autopilot_emulator.hpp"
#include "wire/mavlink/parser.hpp"

namespace vantage::sim {

/// Returns the airframe parameters of an emulated vehicle in `wind`. Without a wind specification,
/// the default light gusts apply.
AirframeParameters airframe_in(const std::optional<scenario::WindSpec>& wind);

/// Quadrotor with an emulated autopilot on a socket. The state of the airframe is the vehicle's
/// true state.
class WireQuadrotor : public EmulatedWireVehicle<AutopilotEmulator> {
 public:
  /// @throws StartupError for a robot without an `autopilot`, with one that cannot be emulated, or
  ///         if a port cannot be opened.
  WireQuadrotor(const scenario::RobotSpec& robot, const std::optional<scenario::WindSpec>& wind,
                std::uint8_t system_id, std::uint64_t seed, Time start);

  void step(Time now, double dt_s) override;
  void exchange(Time now) override;

  /// Returns error counters and ages of received messages, µs. `.pose_…_us` is the time from the
  /// capture of an external pose to its arrival. `.setpoint_…_us` is the time from the capture of
  /// the newest such pose to the arrival of a set-point.
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

 private:
  void measure(const wire::mavlink::Frame& frame, Time arrival);

  wire::mavlink::Parser watcher_;
  Time newest_capture_{};
  LatencyRecord pose_age_;
  LatencyRecord setpoint_age_;
};

}  // namespace vantage::sim
