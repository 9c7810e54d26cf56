#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "sim/autopilot/flight_controller.hpp"
#include "wire/mavlink/parameter.hpp"
#include "wire/mavlink/parser.hpp"

namespace vantage::sim {

/// What an autopilot knows of its battery.
enum class BatteryReport {
  kShare,        ///< its charge
  kVoltageOnly,  ///< without a current sensor
  kFromFull,     ///< it counts the charge used, and takes every battery for full at power-up
};

struct AutopilotEmulatorSpec {
  models::AutopilotDialect dialect = models::AutopilotDialect::kPx4;
  std::uint8_t system_id = 1;
  Pose3 start;  ///< world from body, standing on the ground there
  std::uint64_t seed = 1;
  AirframeParameters airframe;
  BatteryReport battery = BatteryReport::kShare;
};

/// A vehicle with a simulated autopilot at the end of a MAVLink wire. It knows its peer only from
/// the bytes that come, answers as the real autopilots were seen to answer, and flies by what they
/// ask for. Virtual time: handed in, it never asks for it; the same bytes at the same times give
/// the same bytes.
class AutopilotEmulator {
 public:
  static constexpr Duration kStep{5'000};

  AutopilotEmulator(const AutopilotEmulatorSpec& spec, Time boot);

  void receive(std::span<const std::uint8_t> bytes, Time now);
  /// Steps on to `now`, a whole number of steps after boot, and says what became due.
  void advance_to(Time now);
  /// Changes a parameter, or makes one; it starts with those of config/autopilot, as loaded.
  void set_parameter(const std::string& name, double value);
  /// It knows no such parameter any more, and says nothing to the name.
  void forget_parameter(const std::string& name);
  [[nodiscard]] std::optional<double> parameter(const std::string& name) const;

  /// What is to go out, a datagram each; empties it.
  std::vector<std::vector<std::uint8_t>> take_output() { return std::exchange(output_, {}); }

  /// The truth, world z up, body FLU.
  [[nodiscard]] Pose3 world_from_body() const;
  [[nodiscard]] Eigen::Vector3d velocity_world_mps() const;
  [[nodiscard]] const FlightController& controller() const { return controller_; }
  [[nodiscard]] FlightController& controller() { return controller_; }
  /// Frames that came and were ignored because the real one ignores them too.
  [[nodiscard]] std::int64_t ignored() const { return ignored_; }

 private:
  void take(const wire::mavlink::Frame& frame);
  void take_command(const wire::mavlink::CommandLong& command, const wire::mavlink::Origin& from);
  std::uint8_t obey(const wire::mavlink::CommandLong& command);
  std::uint8_t set_interval(const wire::mavlink::CommandLong& command);
  void take_odometry(const wire::mavlink::Odometry& odometry);
  void take_vision(const wire::mavlink::VisionPositionEstimate& vision);
  void take_target(const wire::mavlink::SetPositionTargetLocalNed& target);
  void take_timesync(const wire::mavlink::Timesync& message);
  bool take_parameter_talk(const wire::mavlink::Frame& frame);
  void say_parameter(const std::string& name);
  /// Makes the controller obey the parameters as they are now.
  void obey_parameters();
  [[nodiscard]] bool is_for_me(std::uint8_t target_system) const {
    return target_system == 0 || target_system == spec_.system_id;
  }
  /// Host time to the instant in the vehicle's own clock that it means, as the vehicle knows it.
  [[nodiscard]] Time capture_time(std::uint64_t host_usec) const;
  void speak();
  void speak_once(std::uint32_t message_id);
  [[nodiscard]] bool has_listener() const;
  void say(const wire::mavlink::Statustext& text);
  template <class Message>
  void send(const Message& message);

  AutopilotEmulatorSpec spec_;
  const AutopilotProfile& profile_;
  Time boot_;
  Time now_;
  FlightController controller_;
  wire::mavlink::Parser parser_;
  std::vector<std::vector<std::uint8_t>> output_;
  std::uint8_t next_sequence_ = 0;
  std::uint16_t next_text_ = 0;  ///< of those that go in pieces
  struct Stream {
    Duration interval{};
    Time next{};
  };
  std::map<std::uint32_t, Stream> streams_;
  struct Parameter {
    double value = 0.0;
    std::uint8_t type = wire::mavlink::parameter_type::kFloat;
  };
  std::map<std::string, Parameter> parameters_;
  std::optional<std::int64_t> host_minus_own_ns_;
  std::optional<Time> station_heard_;  ///< its newest heartbeat
  std::int64_t ignored_ = 0;
};

}  // namespace vantage::sim
