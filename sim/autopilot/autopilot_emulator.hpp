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

/// Battery information that an autopilot reports.
enum class BatteryReport {
  kShare,        ///< the state of charge
  kVoltageOnly,  ///< the voltage; the charge is unknown without a current sensor
  kFromFull,     ///< charge by integration of the current; a full battery is assumed at power-up
};

struct AutopilotEmulatorSpec {
  models::AutopilotDialect dialect = models::AutopilotDialect::kPx4;
  std::uint8_t system_id = 1;
  Pose3 start;  ///< world from body; pose on the ground at power-up
  std::uint64_t seed = 1;
  AirframeParameters airframe;
  BatteryReport battery = BatteryReport::kShare;
};

/// Vehicle with an emulated autopilot that communicates by MAVLink. It reacts only to the received
/// bytes, replies as the recorded real autopilots did, and flies as commanded. Time is an argument:
/// the same bytes at the same times produce the same output.
class AutopilotEmulator {
 public:
  static constexpr Duration kStep{5'000};

  AutopilotEmulator(const AutopilotEmulatorSpec& spec, Time boot);

  void receive(std::span<const std::uint8_t> bytes, Time now);
  /// Steps to `now`, an integer number of steps after boot, and queues the messages that became
  /// due.
  void advance_to(Time now);
  /// Sets or creates a parameter. The initial parameters are those in config/autopilot.
  void set_parameter(const std::string& name, double value);
  /// Removes a parameter; requests for it get no reply.
  void forget_parameter(const std::string& name);
  [[nodiscard]] std::optional<double> parameter(const std::string& name) const;

  /// Returns the queued output, one datagram per element, and empties the queue.
  std::vector<std::vector<std::uint8_t>> take_output() { return std::exchange(output_, {}); }

  /// Returns the true pose; world z up, body FLU.
  [[nodiscard]] Pose3 world_from_body() const;
  [[nodiscard]] Eigen::Vector3d velocity_world_mps() const;
  [[nodiscard]] const FlightController& controller() const { return controller_; }
  [[nodiscard]] FlightController& controller() { return controller_; }
  /// Returns the number of ignored frames. The real autopilot ignores such frames too.
  [[nodiscard]] std::int64_t ignored() const { return ignored_; }

 private:
  void take(const wire::mavlink::Frame& frame);
  void take_command(const wire::mavlink::CommandLong& command, const wire::mavlink::Origin& from);
  std::uint8_t execute(const wire::mavlink::CommandLong& command);
  std::uint8_t set_interval(const wire::mavlink::CommandLong& command);
  void take_odometry(const wire::mavlink::Odometry& odometry);
  void take_vision(const wire::mavlink::VisionPositionEstimate& vision);
  void take_target(const wire::mavlink::SetPositionTargetLocalNed& target);
  void take_timesync(const wire::mavlink::Timesync& message);
  bool handle_parameter_message(const wire::mavlink::Frame& frame);
  void send_parameter(const std::string& name);
  /// Applies the present parameters to the controller.
  void apply_parameters();
  [[nodiscard]] bool is_for_me(std::uint8_t target_system) const {
    return target_system == 0 || target_system == spec_.system_id;
  }
  /// Converts host time to this vehicle's clock by the vehicle's estimate of the clock offset.
  [[nodiscard]] Time capture_time(std::uint64_t host_usec) const;
  void send_due();
  void send_stream_message(std::uint32_t message_id);
  [[nodiscard]] bool has_listener() const;
  void send_text(const wire::mavlink::Statustext& text);
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
  std::uint16_t next_text_ = 0;  ///< id of the next text that is sent in several chunks
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
  std::optional<Time> station_heartbeat_;  ///< arrival of the ground station's newest heartbeat
  std::int64_t ignored_ = 0;
};

}  // namespace vantage::sim
