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
#include "models/exchange/messages.hpp"
#include "wire/mavlink/parser.hpp"
#include "wire/mavlink/signing.hpp"

namespace vantage::drivers {

/// One message as it goes onto the wire: a datagram, or bytes of a serial line.
using WireMessage = std::vector<std::uint8_t>;

/// Where a body is and how it moves, from outside.
struct BodyState {
  Time capture{};
  Pose3 world_from_body;
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  double position_sigma_m = 0.01;
  double attitude_sigma_rad = 0.01;
  double velocity_sigma_mps = 0.05;
  std::uint8_t resets = 0;  ///< how often its pose has jumped
};

/// What a vehicle is to do now: be at a place, moving and speeding up like this. Always all of it:
/// ArduPilot starts its position controller anew with each change of kind, and what it did at that
/// moment to brake it then goes on doing (docs/decisions/0009).
struct Setpoint {
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_world_mps2 = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
  double yaw_rate_radps = 0.0;
};

/// The conversation with one autopilot: what has to be said whatever the vehicle does (heartbeat,
/// clock, streams, origin, poses) and the words for what it is to do. Bytes in, bytes out; handed
/// time, it never asks for it.
class AutopilotLink {
 public:
  /// Its parameters are asked for while it is not armed, unless the spec ignores them.
  AutopilotLink(const scenario::AutopilotSpec& spec,
                const std::optional<wire::mavlink::SigningKey>& key);

  /// Takes bytes from the wire: a datagram, or a piece of a stream. True if a frame of the vehicle
  /// was complete with them.
  bool receive(std::span<const std::uint8_t> bytes, bool is_datagram, Time now);
  /// Says what is due. To be called at least 20 times a second.
  void tick(Time now);

  void send_pose(const BodyState& state, Time now);
  void send_setpoint(const Setpoint& setpoint, Time now);
  /// Has a command sent and repeated until it is answered; see CommandSender::want().
  void want(wire::mavlink::CommandLong command, Time now, Duration pause);
  void insist(wire::mavlink::CommandLong command, Time now, Duration period);

  /// What is to go out, in order; empties it.
  std::vector<WireMessage> take_output();

  [[nodiscard]] const Telemetry& telemetry() const { return telemetry_; }
  [[nodiscard]] const CommandSender& commands() const { return commands_; }
  [[nodiscard]] const ParameterCheck& parameters() const { return parameters_; }
  /// Has the parameters that break their rules set; nothing is set while it is armed.
  void mend_parameters() { parameters_.mend(); }
  /// Why there is no conversation, in words; nullopt when there is.
  [[nodiscard]] std::optional<std::string> fault(Time now) const;
  /// Everything that was lost or refused.
  [[nodiscard]] std::vector<models::NamedCount> counters() const;

 private:
  void take(const wire::mavlink::Frame& frame, Time now);
  [[nodiscard]] bool is_of_vehicle(const wire::mavlink::Frame& frame);
  void answer_timesync(const wire::mavlink::Timesync& request, Time now);
  void ask_for_streams(Time now);
  void ask_for_parameters(Time now);
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
  std::map<std::uint32_t, Time> streams_asked_;  ///< when, by message id
  std::uint8_t next_sequence_ = 0;
  bool is_heartbeat_v1_ = false;
  std::optional<Time> last_bytes_;
  Time next_heartbeat_{};
  Time next_second_{};
  Time now_{};
  bool has_component_ = false;  ///< a frame of component 1 was received
  std::int64_t frames_of_vehicle_ = 0;
  std::int64_t strangers_ = 0;  ///< frames of other systems and components
  std::int64_t signatures_refused_ = 0;
};

}  // namespace vantage::drivers
