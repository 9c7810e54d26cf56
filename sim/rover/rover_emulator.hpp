#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>

#include "core/time.hpp"
#include "sim/rover/rover.hpp"
#include "wire/rover/packet.hpp"

namespace vantage::sim {

/// Parameters of an emulated rover, and its deviations from its driver's model.
struct RoverEmulatorSpec {
  std::uint32_t number = 1;
  std::uint32_t boot = 1;
  Pose2 start;  ///< pose (world from body) at the start
  RoverParameters limits;
  double delay_s = 0.03;  ///< s; time from the arrival of a command to its effect
  double grip = 0.97;     ///< ratio of the driven distance to the distance by wheel rotation (slip)
  double drift_radps = 0.02;  ///< rad/s; unmeasured left turn rate while moving
  double battery_share = 0.9;
  double battery_per_s = 1.0 / 7200.0;
};

/// Emulated rover with the protocol of docs/guide/rovers.md. Time and bytes are arguments; `now`
/// must not decrease.
class RoverEmulator {
 public:
  RoverEmulator(const RoverEmulatorSpec& spec, Time start);

  /// Simulates the motion until `now`.
  void advance_to(Time now);
  /// Processes a datagram that arrived at `now`.
  void receive(std::span<const std::uint8_t> datagram, Time now);
  /// Returns the telemetry if it is due.
  std::optional<std::array<std::uint8_t, wire::rover::kTelemetryBytes>> take_output();

  /// Presses the stop button on the rover.
  void press_stop() { is_stopped_ = true; }
  void fail_motor() { has_motor_failed_ = true; }
  void set_battery(double share) { battery_share_ = share; }
  void push_to(const Pose2& world_from_body) { state_.world_from_body = world_from_body; }

  /// Returns the true pose, and the speed and yaw rate of the wheels.
  [[nodiscard]] const RoverState& state() const { return state_; }
  [[nodiscard]] bool is_stopped() const { return is_stopped_; }
  [[nodiscard]] std::int64_t refused() const { return refused_; }

 private:
  struct Demand {
    Time effect{};
    RoverCommand command;
  };
  [[nodiscard]] bool is_watchdog_out() const;
  void step(double dt_s);
  void execute(const wire::rover::Command& command, Time now);

  RoverEmulatorSpec spec_;
  RoverState state_;
  Time now_;
  std::deque<Demand> demands_;  ///< received commands that are not yet in effect
  RoverCommand demand_;
  bool is_driving_ = false;
  bool is_stopped_ = false;
  bool has_motor_failed_ = false;
  double battery_share_;
  std::uint32_t session_ = 0;
  std::uint32_t command_sequence_ = 0;
  std::int64_t command_time_us_ = 0;
  Time command_arrival_{};
  Time next_telemetry_;
  std::uint32_t telemetry_sequence_ = 0;
  std::int64_t refused_ = 0;
};

}  // namespace vantage::sim
