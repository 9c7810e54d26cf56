#include "drivers/quadrotor/autopilot_link.hpp"

#include <algorithm>
#include <limits>

#include "core/axes.hpp"
#include "models/exchange/counts.hpp"
#include "wire/mavlink/constants.hpp"
#include "wire/mavlink/single.hpp"

namespace vantage::drivers {
namespace {

using wire::mavlink::f32;

constexpr Duration kSecond = std::chrono::seconds(1);
// Period of heartbeats; an autopilot detects the loss of heartbeats after one second.
constexpr Duration kHeartbeatPeriod = std::chrono::milliseconds(200);
constexpr Duration kStreamAgeMax = std::chrono::seconds(3);
constexpr Duration kSerialPause = std::chrono::milliseconds(100);
// maximum number of messages to send; when it is exceeded, the oldest half is dropped
constexpr std::size_t kOutputMax = 1024;
constexpr std::uint8_t kLinkId = 1;
constexpr float kNotGiven = std::numeric_limits<float>::quiet_NaN();
// Arbitrary location with a well-defined tangent plane; poses are relative to this origin.
constexpr std::int32_t kOriginLatitudeDegE7 = 399'522'000;
constexpr std::int32_t kOriginLongitudeDegE7 = -751'932'000;
constexpr std::int32_t kOriginAltitudeMm = 10'000;

/// Returns the upper triangle of a diagonal 6×6 covariance matrix, row-major.
std::array<float, 21> covariance(double first_three_sigma, double last_three_sigma) {
  std::array<float, 21> out{};
  for (const std::size_t i : {0U, 6U, 11U}) {
    out[i] = f32(first_three_sigma * first_three_sigma);
  }
  for (const std::size_t i : {15U, 18U, 20U}) {
    out[i] = f32(last_three_sigma * last_three_sigma);
  }
  return out;
}

std::vector<wire::ParameterRule> rules_for(const scenario::AutopilotSpec& spec) {
  return spec.parameters == scenario::ParameterPolicy::kIgnore
             ? std::vector<wire::ParameterRule>()
             : wire::parameter_rules(spec.dialect);
}

}  // namespace

AutopilotLink::AutopilotLink(const scenario::AutopilotSpec& spec,
                             const std::optional<wire::mavlink::SigningKey>& key)
    : dialect_(spec.dialect),
      traits_(traits_of(spec.dialect)),
      system_id_(static_cast<std::uint8_t>(spec.system_id)),
      telemetry_(spec.dialect, spec.battery),
      parameters_(spec.dialect, rules_for(spec)) {
  if (key) {
    signer_.emplace(*key, kLinkId);
  }
}

bool AutopilotLink::receive(std::span<const std::uint8_t> bytes, bool is_datagram, Time now) {
  const std::int64_t before = frames_of_vehicle_;
  const auto handle = [this, now](const wire::mavlink::Frame& frame) { take(frame, now); };
  // After a pause on a serial line, an incomplete frame is not continued.
  if (!is_datagram && last_bytes_ && now - *last_bytes_ > kSerialPause) {
    parser_.flush(handle);
  }
  last_bytes_ = now;
  parser_.feed(bytes, handle);
  if (is_datagram) {
    parser_.flush(handle);
  }
  return frames_of_vehicle_ != before;
}

bool AutopilotLink::is_of_vehicle(const wire::mavlink::Frame& frame) {
  const auto heartbeat = wire::mavlink::unpack<wire::mavlink::Heartbeat>(frame);
  const bool is_autopilots =
      !heartbeat || (heartbeat->autopilot != wire::mavlink::autopilot::kNone &&
                     wire::mavlink::type::is_vehicle(heartbeat->type));
  const std::uint8_t component = frame.origin.component_id;
  // A heartbeat of component 0 is accepted until component 1 was received, since a vehicle may
  // start with component 0. Later such a heartbeat may be from a companion computer, which sends as
  // component 0 by default.
  const bool is_first = component == 0 && heartbeat && !has_component_;
  if (!is_autopilots || (component != wire::mavlink::kComponentAutopilot && !is_first)) {
    return false;
  }
  if (system_id_ == 0) {
    if (!heartbeat) {
      return false;
    }
    system_id_ = frame.origin.system_id;
  }
  if (frame.origin.system_id != system_id_) {
    return false;
  }
  has_component_ = has_component_ || component == wire::mavlink::kComponentAutopilot;
  return true;
}

void AutopilotLink::take(const wire::mavlink::Frame& frame, Time now) {
  if (signer_ && signer_->check(frame, now) != wire::mavlink::SignatureVerdict::kGood) {
    ++signatures_refused_;
    return;
  }
  if (!is_of_vehicle(frame)) {
    ++strangers_;
    return;
  }
  ++frames_of_vehicle_;
  sequence_.on_frame(frame.origin);
  telemetry_.take(frame, now);
  if (telemetry_.reconnections() != reconnections_seen_) {
    reconnections_seen_ = telemetry_.reconnections();
    parameters_.restart();
  }
  if (frame.message_id == wire::mavlink::Heartbeat::kMessage.id) {
    is_heartbeat_v1_ = frame.is_v1;
  } else if (const auto timesync = wire::mavlink::unpack<wire::mavlink::Timesync>(frame)) {
    answer_timesync(*timesync, now);
  } else if (const auto ack = wire::mavlink::unpack<wire::mavlink::CommandAck>(frame)) {
    const bool is_mine = ack->target_system == 0 || ack->target_system == traits_.own_system_id;
    if (is_mine) {
      commands_.acknowledge(*ack, now);
    }
  } else if (const auto value = wire::mavlink::unpack<wire::mavlink::ParamValue>(frame)) {
    parameters_.take(*value, now);
  }
}

void AutopilotLink::answer_timesync(const wire::mavlink::Timesync& request, Time now) {
  if (request.tc1 != 0) {
    return;
  }
  wire::mavlink::Timesync reply;
  reply.tc1 = to_utime(now) * 1000;
  reply.ts1 = request.ts1;
  reply.target_system = system_id_;
  reply.target_component = wire::mavlink::kComponentAutopilot;
  send(reply, now);
}

void AutopilotLink::tick(Time now) {
  now_ = now;
  if (now >= next_heartbeat_) {
    next_heartbeat_ = now + kHeartbeatPeriod;
    send(wire::mavlink::heartbeat_of(traits_.own_type), now);
  }
  if (now >= next_second_) {
    next_second_ = now + kSecond;
    if (telemetry_.is_connected(now)) {
      wire::mavlink::Timesync request;
      request.ts1 = to_utime(now) * 1000;
      request.target_system = system_id_;
      request.target_component = wire::mavlink::kComponentAutopilot;
      send(request, now);
      if (traits_.needs_origin && !telemetry_.has_origin()) {
        send_origin();
      }
    }
  }
  if (telemetry_.is_connected(now)) {
    request_streams(now);
    request_parameters(now);
  }
  for (wire::mavlink::CommandLong& command : commands_.due(now)) {
    send(command, now);
  }
}

void AutopilotLink::request_streams(Time now) {
  if (commands_.is_under_way(wire::mavlink::command::kSetMessageInterval)) {
    return;  // acknowledgements do not name the message: send one request at a time
  }
  for (const WantedStream& stream : traits_.streams) {
    const std::optional<Time> received_at = telemetry_.received_at(stream.message_id);
    const auto requested = streams_requested_.find(stream.message_id);
    if ((received_at && now - *received_at <= kStreamAgeMax) ||
        (requested != streams_requested_.end() && now - requested->second <= kStreamAgeMax)) {
      continue;
    }
    wire::mavlink::CommandLong command;
    command.command = wire::mavlink::command::kSetMessageInterval;
    command.param1 = static_cast<float>(stream.message_id);
    command.param2 = f32(1e6 / stream.rate_hz);
    streams_requested_[stream.message_id] = now;
    send_command(command, now, Duration{0});
    return;
  }
}

void AutopilotLink::request_parameters(Time now) {
  if (telemetry_.is_armed()) {
    return;  // in flight, the link is reserved for flight control
  }
  ParameterCheck::Due due = parameters_.due(now);
  const auto address_and_send = [&](auto& message) {
    message.target_system = system_id_;
    message.target_component = wire::mavlink::kComponentAutopilot;
    send(message, now);
  };
  std::for_each(due.reads.begin(), due.reads.end(), address_and_send);
  std::for_each(due.sets.begin(), due.sets.end(), address_and_send);
}

void AutopilotLink::send_origin() {
  wire::mavlink::SetGpsGlobalOrigin origin;
  origin.latitude = kOriginLatitudeDegE7;
  origin.longitude = kOriginLongitudeDegE7;
  origin.altitude = kOriginAltitudeMm;
  origin.target_system = system_id_;
  origin.time_usec = static_cast<std::uint64_t>(to_utime(now_));
  send(origin, now_);
}

void AutopilotLink::send_pose(const BodyState& state, Time now) {
  const Eigen::Vector3d position_m = convert_axes(state.world_from_body.translation_m);
  const Quaternion local_from_body = convert_axes(state.world_from_body.rotation);
  const Eigen::Vector3d velocity_body_mps =
      local_from_body.conjugate() * convert_axes(state.velocity_world_mps);
  wire::mavlink::Odometry odometry;
  odometry.time_usec =
      static_cast<std::uint64_t>(std::max<std::int64_t>(0, to_utime(state.capture)));
  odometry.x = f32(position_m.x());
  odometry.y = f32(position_m.y());
  odometry.z = f32(position_m.z());
  odometry.q = {f32(local_from_body.w()), f32(local_from_body.x()), f32(local_from_body.y()),
                f32(local_from_body.z())};
  odometry.vx = f32(velocity_body_mps.x());
  odometry.vy = f32(velocity_body_mps.y());
  odometry.vz = f32(velocity_body_mps.z());
  odometry.rollspeed = kNotGiven;
  odometry.pitchspeed = kNotGiven;
  odometry.yawspeed = kNotGiven;
  odometry.pose_covariance = covariance(state.position_sigma_m, state.attitude_sigma_rad);
  odometry.velocity_covariance = covariance(state.velocity_sigma_mps, 1.0);
  odometry.frame_id = wire::mavlink::frame::kLocalFrd;
  odometry.child_frame_id = wire::mavlink::frame::kBodyFrd;
  odometry.reset_counter = state.resets;
  odometry.estimator_type = wire::mavlink::kEstimatorVision;
  odometry.quality = 100;
  send(odometry, now);
}

void AutopilotLink::send_setpoint(const Setpoint& setpoint, Time now) {
  wire::mavlink::SetPositionTargetLocalNed target;
  target.time_boot_ms = static_cast<std::uint32_t>(to_utime(now) / 1000);
  target.target_system = system_id_;
  target.target_component = wire::mavlink::kComponentAutopilot;
  target.coordinate_frame = wire::mavlink::frame::kLocalNed;
  target.type_mask = wire::mavlink::mask::kNothingIgnored;
  const Eigen::Vector3d position_m = convert_axes(setpoint.position_world_m);
  const Eigen::Vector3d velocity_mps = convert_axes(setpoint.velocity_world_mps);
  const Eigen::Vector3d acceleration_mps2 = convert_axes(setpoint.acceleration_world_mps2);
  target.x = f32(position_m.x());
  target.y = f32(position_m.y());
  target.z = f32(position_m.z());
  target.vx = f32(velocity_mps.x());
  target.vy = f32(velocity_mps.y());
  target.vz = f32(velocity_mps.z());
  target.afx = f32(acceleration_mps2.x());
  target.afy = f32(acceleration_mps2.y());
  target.afz = f32(acceleration_mps2.z());
  target.yaw = f32(convert_yaw(setpoint.yaw_rad));
  target.yaw_rate = f32(convert_yaw(setpoint.yaw_rate_radps));
  send(target, now);
}

void AutopilotLink::send_command(wire::mavlink::CommandLong command, Time now, Duration pause) {
  command.target_system = system_id_;
  command.target_component = wire::mavlink::kComponentAutopilot;
  commands_.send_command(command, now, pause);
}

void AutopilotLink::send_command_periodically(wire::mavlink::CommandLong command, Time now,
                                              Duration period) {
  command.target_system = system_id_;
  command.target_component = wire::mavlink::kComponentAutopilot;
  commands_.send_command_periodically(command, now, period);
}

template <class Message>
void AutopilotLink::send(const Message& message, Time now) {
  wire::mavlink::Frame frame = wire::mavlink::pack(
      message, {traits_.own_system_id, wire::mavlink::kComponentOnboardComputer, next_sequence_++});
  if (signer_) {
    signer_->sign(frame, now);
  }
  if (output_.size() >= kOutputMax) {
    output_.erase(output_.begin(), output_.begin() + kOutputMax / 2);
  }
  wire::mavlink::append_bytes(frame, output_.emplace_back());
}

std::vector<WireMessage> AutopilotLink::take_output() { return std::exchange(output_, {}); }

std::optional<std::string> AutopilotLink::fault(Time now) const {
  if (!telemetry_.heartbeat_time()) {
    return strangers_ > 0 ? "messages received, but none from an autopilot with this system id"
                          : "no message received from an autopilot";
  }
  if (!telemetry_.is_connected(now)) {
    return "the autopilot's messages have stopped";
  }
  if (telemetry_.autopilot() != traits_.autopilot_id) {
    return "the autopilot is not " + std::string(traits_.name);
  }
  if (is_heartbeat_v1_) {
    return "the autopilot sends MAVLink 1; version 2 is required";
  }
  return std::nullopt;
}

std::vector<models::NamedCount> AutopilotLink::counters() const {
  const wire::mavlink::ParserCounts& parsed = parser_.counts();
  return models::nonzero({{"mavlink.frames_lost", sequence_.lost()},
                          {"mavlink.frames_out_of_order", sequence_.out_of_order()},
                          {"mavlink.bytes_skipped", parsed.bytes_skipped},
                          {"mavlink.frames_v1", parsed.frames_v1},
                          {"mavlink.unknown_flags", parsed.unknown_flags},
                          {"mavlink.signatures_refused", signatures_refused_},
                          {"mavlink.commands_unanswered", commands_.unanswered()}});
}

}  // namespace vantage::drivers
