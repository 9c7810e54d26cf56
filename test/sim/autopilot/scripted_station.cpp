#include "test/sim/autopilot/scripted_station.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <utility>

#include "core/axes.hpp"
#include "wire/mavlink/parameter.hpp"
#include "wire/mavlink/single.hpp"

namespace vantage::test {
namespace {

using wire::mavlink::f32;

constexpr std::int64_t kHeartbeatTicks = 10;
constexpr int kPatienceTicks = 50;
constexpr float kNotGiven = std::numeric_limits<float>::quiet_NaN();

/// Returns the upper triangle, row-major, of a 6×6 matrix with `variance` on its diagonal.
std::array<float, 21> covariance(double variance) {
  std::array<float, 21> out{};
  for (const std::size_t i : {0U, 6U, 11U, 15U, 18U, 20U}) {
    out[i] = f32(variance);
  }
  return out;
}

std::string one_line(const char* text, std::size_t room) {
  std::string out(text, std::find(text, text + room, '\0'));
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c < ' '; }, ' ');
  return out.substr(0, out.find_last_not_of(' ') + 1);
}

wire::mavlink::SetPositionTargetLocalNed local_target(std::uint16_t mask) {
  wire::mavlink::SetPositionTargetLocalNed out;
  out.type_mask = mask;
  out.coordinate_frame = wire::mavlink::frame::kLocalNed;
  return out;
}

}  // namespace

void ScriptedStation::tick() {
  if (sends_heartbeats && ticks_ % kHeartbeatTicks == 0) {
    send(wire::mavlink::heartbeat_of(wire::mavlink::type::kGroundStation));
  }
  if (sends_poses) {
    send_pose();
  }
  if (target) {
    send(*target);
  }
  ++ticks_;
  now += kTick;
  pass();
}

void ScriptedStation::run(double seconds) {
  const Time end = now + from_seconds(seconds);
  while (now < end) {
    tick();
  }
}

int ScriptedStation::command(std::uint16_t number, float p1, float p2, float p3, float p7) {
  last_ack.reset();
  wire::mavlink::CommandLong out;
  out.command = number;
  out.param1 = p1;
  out.param2 = p2;
  out.param3 = p3;
  out.param7 = p7;
  out.target_system = 1;
  out.target_component = 1;
  send(out);
  const auto is_answered = [&] { return last_ack && last_ack->command == number; };
  for (int i = 0; i < kPatienceTicks && !is_answered(); ++i) {
    tick();
  }
  return is_answered() ? last_ack->result : -1;
}

void ScriptedStation::set_parameter(const std::string& name, double value) {
  last_parameter.reset();
  wire::mavlink::ParamSet out;
  out.param_value = f32(value);
  out.param_type = wire::mavlink::parameter_type::kFloat;
  out.param_id = wire::mavlink::parameter_id(name);
  out.target_system = 1;
  out.target_component = 1;
  send(out);
  for (int i = 0; i < kPatienceTicks && !last_parameter; ++i) {
    tick();
  }
}

void ScriptedStation::send_pose() {
  const Body from = seen();
  const Eigen::Vector3d position_m =
      convert_axes(from.world_from_body.translation_m) + pose_offset_m;
  const Eigen::Quaterniond local_from_body = convert_axes(from.world_from_body.rotation);
  const Eigen::Vector3d velocity_mps =
      local_from_body.conjugate() * convert_axes(from.velocity_world_mps);
  wire::mavlink::Odometry odometry;
  odometry.time_usec = static_cast<std::uint64_t>(to_utime(from.time));
  odometry.x = f32(position_m.x());
  odometry.y = f32(position_m.y());
  odometry.z = f32(position_m.z());
  odometry.q = {f32(local_from_body.w()), f32(local_from_body.x()), f32(local_from_body.y()),
                f32(local_from_body.z())};
  odometry.vx = f32(velocity_mps.x());
  odometry.vy = f32(velocity_mps.y());
  odometry.vz = f32(velocity_mps.z());
  odometry.rollspeed = kNotGiven;
  odometry.pitchspeed = kNotGiven;
  odometry.yawspeed = kNotGiven;
  odometry.pose_covariance = covariance(1e-4);
  odometry.velocity_covariance = covariance(1e-3);
  odometry.frame_id = frame;
  odometry.child_frame_id = wire::mavlink::frame::kBodyFrd;
  odometry.estimator_type = estimator_type;
  odometry.quality = 100;
  send(odometry);
}

wire::mavlink::SetPositionTargetLocalNed ScriptedStation::velocity(float vx, float vy, float vz,
                                                                   float yaw_rate) {
  wire::mavlink::SetPositionTargetLocalNed out =
      local_target(wire::mavlink::mask::kVelocityAndYawRate);
  out.vx = vx;
  out.vy = vy;
  out.vz = vz;
  out.yaw_rate = yaw_rate;
  return out;
}

wire::mavlink::SetPositionTargetLocalNed ScriptedStation::position(float x, float y, float z,
                                                                   float yaw) {
  wire::mavlink::SetPositionTargetLocalNed out = local_target(wire::mavlink::mask::kPositionAndYaw);
  out.x = x;
  out.y = y;
  out.z = z;
  out.yaw = yaw;
  return out;
}

void ScriptedStation::note(const std::string& kind, const std::string& what) {
  if (recording != nullptr) {
    recording->note(time_s(), kind, what);
  }
}

void ScriptedStation::receive(std::span<const std::uint8_t> bytes) {
  parser_.feed(bytes, [this](const wire::mavlink::Frame& got) { receive(got); });
  if (const auto reply = std::exchange(owed_, std::nullopt)) {
    send(*reply);
  }
}

void ScriptedStation::receive(const wire::mavlink::Frame& got) {
  const auto hear_flags = [this](std::uint16_t fresh) {
    if (fresh != flags) {
      constexpr const char* kDigits = "0123456789ABCDEF";
      std::string text = "0x";
      for (int shift = 12; shift >= 0; shift -= 4) {
        text += kDigits[fresh >> shift & 0xF];
      }
      note("flags", text);
    }
    flags = fresh;
  };
  if (got.origin.system_id != 1) {
    return;
  }
  if (const auto ack = wire::mavlink::unpack<wire::mavlink::CommandAck>(got)) {
    last_ack = ack;
    if (ack->command != wire::mavlink::command::kSetMessageInterval) {
      note("ack", std::to_string(ack->command) + " " + std::to_string(ack->result));
    }
  } else if (const auto text = wire::mavlink::unpack<wire::mavlink::Statustext>(got)) {
    last_text = one_line(text->text.data(), text->text.size());
    note("text", last_text);
  } else if (const auto heartbeat = wire::mavlink::unpack<wire::mavlink::Heartbeat>(got)) {
    const bool was_armed = reports_armed();
    const bool is_new_mode =
        !last_heartbeat || last_heartbeat->custom_mode != heartbeat->custom_mode;
    last_heartbeat = heartbeat;
    if (is_new_mode) {
      note("mode", std::to_string(heartbeat->custom_mode));
    }
    if (reports_armed() != was_armed) {
      note("armed", reports_armed() ? "yes" : "no");
    }
  } else if (const auto px4 = wire::mavlink::unpack<wire::mavlink::EstimatorStatus>(got)) {
    hear_flags(px4->flags);
  } else if (const auto ekf = wire::mavlink::unpack<wire::mavlink::EkfStatusReport>(got)) {
    hear_flags(ekf->flags);
  } else if (const auto state = wire::mavlink::unpack<wire::mavlink::ExtendedSysState>(got)) {
    if (state->landed_state != landed) {
      note("landed", std::to_string(state->landed_state));
    }
    landed = state->landed_state;
  } else if (const auto value = wire::mavlink::unpack<wire::mavlink::ParamValue>(got)) {
    last_parameter = value;
  } else if (const auto battery = wire::mavlink::unpack<wire::mavlink::BatteryStatus>(got)) {
    last_battery = battery;
  } else if (const auto timesync = wire::mavlink::unpack<wire::mavlink::Timesync>(got)) {
    if (timesync->tc1 == 0) {
      owed_.emplace();
      owed_->tc1 = to_utime(now) * 1000;
      owed_->ts1 = timesync->ts1;
      owed_->target_system = 1;
      owed_->target_component = 1;
    }
  } else if (got.message_id == wire::mavlink::GpsGlobalOrigin::kMessage.id) {
    ++origins;
    note("origin", "confirmed");
  } else if (got.message_id == wire::mavlink::LocalPositionNed::kMessage.id) {
    if (positions++ == 0) {
      note("position", "first");
    }
  }
}

}  // namespace vantage::test
