#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "drivers/quadrotor/command_sender.hpp"
#include "drivers/quadrotor/dialect.hpp"
#include "drivers/quadrotor/parameter_check.hpp"
#include "drivers/quadrotor/telemetry.hpp"
#include "drivers/safety/setpoint.hpp"
#include "drivers/vehicle/body_tracker.hpp"
#include "models/exchange/messages.hpp"
#include "wire/mavlink/parser.hpp"
#include "wire/mavlink/signing.hpp"

namespace vantage::drivers {

/// Message to send: a datagram, or bytes for a serial line.
using WireMessage = std::vector<std::uint8_t>;

/// MAVLink connection with one autopilot: periodic messages (heartbeat, clock, streams, origin,
/// poses), set-points and commands. Received bytes and the time are passed in; bytes to send are
/// returned.
class AutopilotLink {
 public:
  /// Parameters are requested while the autopilot is not armed, unless `spec` ignores them.
  AutopilotLink(const scenario::AutopilotSpec& spec,
                const std::optional<wire::mavlink::SigningKey>& key);

  /// Processes bytes: a datagram, or a piece of a stream. Returns true if they completed a frame of
  /// the vehicle.
  bool receive(std::span<const std::uint8_t> bytes, bool is_datagram, Time now);
  /// Sends all pending messages. Call it at least 20 times per second.
  void tick(Time now);

  void send_pose(const BodyState& state, Time now);
  void send_setpoint(const Setpoint& setpoint, Time now);
  /// Sends a command and repeats it until it is acknowledged; see CommandSender::send_command().
  void send_command(wire::mavlink::CommandLong command, Time now, Duration pause);
  void send_command_periodically(wire::mavlink::CommandLong command, Time now, Duration period);

  /// Returns the messages to send in order, and removes them.
  std::vector<WireMessage> take_output();

  [[nodiscard]] const Telemetry& telemetry() const { return telemetry_; }
  [[nodiscard]] const CommandSender& commands() const { return commands_; }
  [[nodiscard]] const ParameterCheck& parameters() const { return parameters_; }
  /// Sets the parameters that violate their rules; nothing is set while the autopilot is armed.
  void repair_parameters() { parameters_.repair(); }
  /// Returns a text that states why the connection does not work; nullopt if it works.
  [[nodiscard]] std::optional<std::string> fault(Time now) const;
  /// Returns the counters of lost and refused messages.
  [[nodiscard]] std::vector<models::NamedCount> counters() const;

 private:
  void take(const wire::mavlink::Frame& frame, Time now);
  [[nodiscard]] bool is_of_vehicle(const wire::mavlink::Frame& frame);
  void answer_timesync(const wire::mavlink::Timesync& request, Time now);
  void request_streams(Time now);
  void request_parameters(Time now);
  void send_origin();
  template <class Message>
  void send(const Message& message, Time now);

  models::AutopilotDialect dialect_;
  const DialectTraits& traits_;
  std::uint8_t system_id_;
  std::optional<wire::mavlink::Signer> signer_;
  wire::mavlink::Parser parser_;
  wire::mavlink::SequenceMonitor sequence_;
  Telemetry telemetry_;
  CommandSender commands_;
  ParameterCheck parameters_;
  std::int64_t reconnections_seen_ = 0;
  std::vector<WireMessage> output_;
  std::map<std::uint32_t, Time> streams_requested_;  ///< time of the last request, by message id
  std::uint8_t next_sequence_ = 0;
  bool is_heartbeat_v1_ = false;
  std::optional<Time> last_bytes_;
  Time next_heartbeat_{};
  Time next_second_{};
  Time now_{};
  bool has_component_ = false;  ///< a frame of component 1 (the autopilot) was received
  std::int64_t frames_of_vehicle_ = 0;
  std::int64_t strangers_ = 0;  ///< number of frames from other systems and components
  std::int64_t signatures_refused_ = 0;
};

}  // namespace vantage::drivers
