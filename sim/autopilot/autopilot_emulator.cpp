#include "sim/autopilot/autopilot_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "wire/autopilot/parameter_rules.hpp"
#include "wire/mavlink/constants.hpp"

namespace vantage::sim {
namespace {

constexpr std::uint32_t kTimesyncId = wire::mavlink::Timesync::kMessage.id;

/// Converts between the stack's axes (z up) and the autopilot's (z down), in both directions.
Eigen::Vector3d turn(const Eigen::Vector3d& v) { return {v.x(), -v.y(), -v.z()}; }

}  // namespace

AutopilotEmulator::AutopilotEmulator(const AutopilotEmulatorSpec& spec, Time boot)
    : spec_(spec),
      profile_(profile_of(spec.dialect)),
      boot_(boot),
      now_(boot),
      controller_(profile_, AutopilotSettings{}, spec.airframe, spec.seed,
                  turn(spec.start.translation_m), -flatten(spec.start).yaw_rad, boot) {
  streams_[wire::mavlink::Heartbeat::kMessage.id] = {std::chrono::seconds(1), boot};
  const bool is_px4 = spec.dialect == models::AutopilotDialect::kPx4;
  streams_[kTimesyncId] = {is_px4 ? Duration{100'000} : Duration{10'000'000}, boot};
  for (const wire::ParameterRule& rule : wire::parameter_rules(spec.dialect)) {
    set_parameter(rule.name, rule.value);
  }
}

Pose3 AutopilotEmulator::world_from_body() const {
  const Quaternion q = controller_.airframe().local_from_body();
  return {turn(controller_.airframe().position_m()), Quaternion(q.w(), q.x(), -q.y(), -q.z())};
}

Eigen::Vector3d AutopilotEmulator::velocity_world_mps() const {
  return turn(controller_.airframe().velocity_mps());
}

void AutopilotEmulator::receive(std::span<const std::uint8_t> bytes, Time now) {
  now_ = std::max(now_, now);
  parser_.feed(bytes, [this](const wire::mavlink::Frame& frame) { take(frame); });
}

void AutopilotEmulator::take(const wire::mavlink::Frame& frame) {
  if (const auto command = wire::mavlink::unpack<wire::mavlink::CommandLong>(frame)) {
    if (is_for_me(command->target_system)) {
      take_command(*command, frame.origin);
    }
  } else if (const auto odometry = wire::mavlink::unpack<wire::mavlink::Odometry>(frame)) {
    take_odometry(*odometry);
  } else if (const auto vision =
                 wire::mavlink::unpack<wire::mavlink::VisionPositionEstimate>(frame)) {
    take_vision(*vision);
  } else if (const auto target =
                 wire::mavlink::unpack<wire::mavlink::SetPositionTargetLocalNed>(frame)) {
    if (is_for_me(target->target_system)) {
      take_target(*target);
    }
  } else if (const auto timesync = wire::mavlink::unpack<wire::mavlink::Timesync>(frame)) {
    take_timesync(*timesync);
  } else if (const auto heartbeat = wire::mavlink::unpack<wire::mavlink::Heartbeat>(frame)) {
    if (heartbeat->type == wire::mavlink::type::kGroundStation) {
      station_heartbeat_ = now_;
    }
    controller_.take_heartbeat(frame.origin.system_id, now_);
  } else if (handle_parameter_message(frame)) {
    return;
  } else if (const auto origin = wire::mavlink::unpack<wire::mavlink::SetGpsGlobalOrigin>(frame)) {
    // The first origin is accepted and confirmed; later origins get no reply.
    if (is_for_me(origin->target_system) && controller_.has_estimator(now_) &&
        !controller_.has_origin()) {
      controller_.set_origin();
      send(
          wire::mavlink::GpsGlobalOrigin{origin->latitude, origin->longitude, origin->altitude, 0});
    }
  }
}

void AutopilotEmulator::take_command(const wire::mavlink::CommandLong& command,
                                     const wire::mavlink::Origin& from) {
  wire::mavlink::CommandAck ack;
  ack.command = command.command;
  ack.result = execute(command);
  ack.target_system = from.system_id;
  ack.target_component = from.component_id;
  // Sends the texts with the reason before the refusal.
  send_due();
  send(ack);
}

std::uint8_t AutopilotEmulator::execute(const wire::mavlink::CommandLong& command) {
  constexpr std::uint8_t kUnsupported = 3;
  const bool is_px4 = spec_.dialect == models::AutopilotDialect::kPx4;
  switch (command.command) {
    case wire::mavlink::command::kArmDisarm:
      return command.param1 > 0.5F
                 ? controller_.arm(now_)
                 : controller_.disarm(command.param2 == wire::mavlink::kForceDisarm);
    case wire::mavlink::command::kSetMode: {
      const auto main = static_cast<std::uint32_t>(command.param2);
      const auto sub = static_cast<std::uint32_t>(command.param3);
      return controller_.set_mode(is_px4 ? main << 16U | sub << 24U : main, now_);
    }
    case wire::mavlink::command::kTakeOff:
      return controller_.take_off(static_cast<double>(command.param7));
    case wire::mavlink::command::kLand:
      return controller_.set_mode(profile_.land_mode, now_);
    case wire::mavlink::command::kSetMessageInterval:
      return set_interval(command);
    default:
      return kUnsupported;
  }
}

std::uint8_t AutopilotEmulator::set_interval(const wire::mavlink::CommandLong& command) {
  const auto id = static_cast<std::uint32_t>(command.param1);
  const bool is_px4 = spec_.dialect == models::AutopilotDialect::kPx4;
  const bool is_of_other = id == (is_px4 ? wire::mavlink::EkfStatusReport::kMessage.id
                                         : wire::mavlink::EstimatorStatus::kMessage.id);
  if (wire::mavlink::find_message(id) == nullptr || is_of_other || !(command.param2 >= 5000.0F)) {
    return 4;
  }
  streams_[id] = {Duration{static_cast<std::int64_t>(command.param2)}, now_};
  return 0;
}

Time AutopilotEmulator::capture_time(std::uint64_t host_usec) const {
  if (!host_minus_own_ns_) {
    return now_;
  }
  const std::int64_t own_us = static_cast<std::int64_t>(host_usec) - *host_minus_own_ns_ / 1000;
  return std::min(now_, boot_ + Duration{own_us});
}

void AutopilotEmulator::take_odometry(const wire::mavlink::Odometry& odometry) {
  const Eigen::Vector3d position_m(odometry.x, odometry.y, odometry.z);
  if (spec_.dialect == models::AutopilotDialect::kArdupilot) {
    if (odometry.frame_id != wire::mavlink::frame::kLocalFrd ||
        odometry.child_frame_id != wire::mavlink::frame::kBodyFrd || !position_m.allFinite()) {
      ++ignored_;
      return;
    }
    controller_.take_pose(now_, capture_time(odometry.time_usec), position_m,
                          odometry.reset_counter);
    return;
  }
  // Types up to this one are fused: unknown, naive, vision, visual-inertial.
  constexpr std::uint8_t kLastFused = 3;
  constexpr std::uint8_t kMocap = 6;
  if (odometry.estimator_type > kLastFused) {
    if (odometry.estimator_type != kMocap) {
      wire::mavlink::Statustext text;
      text.severity = 2;
      const char* const words = "ODOMETRY: estimator_type unsupported";
      std::copy_n(words, std::strlen(words), text.text.begin());
      send_text(text);
    }
    ++ignored_;  // mocap messages are also ignored: the estimator does not read their topic
    return;
  }
  constexpr std::uint8_t kLocalEnu = 4;
  constexpr std::uint8_t kLocalFlu = 21;
  Eigen::Vector3d local_m = position_m;
  if (odometry.frame_id == kLocalEnu) {
    local_m = {position_m.y(), position_m.x(), -position_m.z()};
  } else if (odometry.frame_id == kLocalFlu) {
    local_m = turn(position_m);
  } else if (odometry.frame_id != wire::mavlink::frame::kLocalNed &&
             odometry.frame_id != wire::mavlink::frame::kLocalFrd) {
    ++ignored_;
    return;
  }
  if (local_m.allFinite()) {
    controller_.take_pose(now_, capture_time(odometry.time_usec), local_m, odometry.reset_counter);
  }
}

void AutopilotEmulator::take_vision(const wire::mavlink::VisionPositionEstimate& vision) {
  const Eigen::Vector3d position_m(vision.x, vision.y, vision.z);
  if (position_m.allFinite()) {
    controller_.take_pose(now_, capture_time(vision.usec), position_m, vision.reset_counter);
  }
}

void AutopilotEmulator::take_target(const wire::mavlink::SetPositionTargetLocalNed& message) {
  namespace mask = wire::mavlink::mask;
  const auto has = [&](std::uint16_t bits) { return (message.type_mask & bits) != 0; };
  const bool is_body = message.coordinate_frame == wire::mavlink::frame::kBodyNed;
  if ((message.coordinate_frame != wire::mavlink::frame::kLocalNed && !is_body) ||
      has(mask::kIsForce)) {
    ++ignored_;
    return;
  }
  FlightTarget target;
  if (!has(mask::kIgnorePosition) && !is_body) {
    target.position_m = Eigen::Vector3d(message.x, message.y, message.z);
  }
  if (!has(mask::kIgnoreVelocity)) {
    Eigen::Vector3d velocity_mps(message.vx, message.vy, message.vz);
    if (is_body) {
      velocity_mps = Eigen::AngleAxisd(controller_.airframe().yaw_rad(), Eigen::Vector3d::UnitZ()) *
                     velocity_mps;
    }
    target.velocity_mps = velocity_mps;
  }
  if (!has(mask::kIgnoreAcceleration)) {
    target.acceleration_mps2 = Eigen::Vector3d(message.afx, message.afy, message.afz);
  }
  if (!has(mask::kIgnoreYaw)) {
    target.yaw_rad = static_cast<double>(message.yaw);
  }
  if (!has(mask::kIgnoreYawRate)) {
    target.yaw_rate_radps = static_cast<double>(message.yaw_rate);
  }
  controller_.take_target(target, now_);
}

void AutopilotEmulator::take_timesync(const wire::mavlink::Timesync& message) {
  const std::int64_t own_ns = (now_ - boot_).count() * 1000;
  if (message.tc1 == 0) {
    wire::mavlink::Timesync reply;
    reply.tc1 = own_ns;
    reply.ts1 = message.ts1;
    send(reply);
  } else if (message.ts1 <= own_ns) {
    host_minus_own_ns_ = message.tc1 - (message.ts1 + own_ns) / 2;
  }
}

void AutopilotEmulator::set_parameter(const std::string& name, double value) {
  const auto [found, is_new] = parameters_.try_emplace(name);
  found->second.value = value;
  if (is_new && std::trunc(value) == value) {
    found->second.type = wire::mavlink::parameter_type::kInt32;
  }
  apply_parameters();
}

void AutopilotEmulator::forget_parameter(const std::string& name) {
  parameters_.erase(name);
  apply_parameters();
}

void AutopilotEmulator::apply_parameters() {
  controller_.set_settings(
      settings_of(spec_.dialect, [this](const std::string& name) { return parameter(name); }));
}

std::optional<double> AutopilotEmulator::parameter(const std::string& name) const {
  const auto found = parameters_.find(name);
  return found == parameters_.end() ? std::nullopt : std::optional(found->second.value);
}

bool AutopilotEmulator::handle_parameter_message(const wire::mavlink::Frame& frame) {
  if (const auto read = wire::mavlink::unpack<wire::mavlink::ParamRequestRead>(frame)) {
    if (is_for_me(read->target_system)) {
      send_parameter(wire::mavlink::parameter_name(read->param_id));
    }
    return true;
  }
  const auto set = wire::mavlink::unpack<wire::mavlink::ParamSet>(frame);
  if (!set) {
    return false;
  }
  const auto found = parameters_.find(wire::mavlink::parameter_name(set->param_id));
  if (is_for_me(set->target_system) && found != parameters_.end()) {
    found->second.value = wire::mavlink::decode_parameter(set->param_value, set->param_type,
                                                          wire::parameter_encoding(spec_.dialect));
    apply_parameters();
    send_parameter(found->first);
  }
  return true;
}

void AutopilotEmulator::send_parameter(const std::string& name) {
  const auto found = parameters_.find(name);
  if (found == parameters_.end()) {
    ++ignored_;  // no reply to an unknown name, as in both firmwares
    return;
  }
  const auto& [value, type] = found->second;
  wire::mavlink::ParamValue out;
  out.param_id = wire::mavlink::parameter_id(name);
  out.param_type = type;
  out.param_value =
      wire::mavlink::encode_parameter(value, type, wire::parameter_encoding(spec_.dialect));
  out.param_count = static_cast<std::uint16_t>(parameters_.size());
  out.param_index = 0xFFFF;
  send(out);
}

void AutopilotEmulator::advance_to(Time now) {
  // Steps end at integer multiples of kStep after boot.
  for (Time next = boot_ + ((now_ - boot_) / kStep + 1) * kStep; next <= now; next += kStep) {
    now_ = next;
    controller_.step(next, to_seconds(kStep));
    send_due();
  }
}

}  // namespace vantage::sim
