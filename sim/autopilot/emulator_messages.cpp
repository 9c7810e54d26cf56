// Messages that the emulated autopilot sends without a request: streams, and the texts of its
// controller.

#include <algorithm>
#include <cmath>

#include "sim/autopilot/autopilot_emulator.hpp"
#include "wire/mavlink/constants.hpp"
#include "wire/mavlink/single.hpp"

namespace vantage::sim {
namespace {

using wire::mavlink::f32;

constexpr std::size_t kOutputMax = 1024;  // datagrams; if there are more, the older half is dropped
constexpr std::uint8_t kQuadrotor = 2;
constexpr std::uint8_t kStandby = 3;
constexpr std::uint16_t kNoVoltage = 0xFFFF;

wire::mavlink::BatteryStatus battery_status(const Airframe& airframe, BatteryReport report) {
  wire::mavlink::BatteryStatus out;
  out.battery_remaining =
      report == BatteryReport::kVoltageOnly ? std::int8_t{-1}
      : report == BatteryReport::kFromFull
          ? std::int8_t{100}
          : static_cast<std::int8_t>(std::lround(100.0 * airframe.battery_share()));
  out.voltages.fill(kNoVoltage);
  out.voltages[0] = static_cast<std::uint16_t>(std::lround(1000.0 * airframe.battery_v()));
  out.current_battery = static_cast<std::int16_t>(std::lround(2500.0 * airframe.thrust_share()));
  out.temperature = 2500;
  out.charge_state = airframe.battery_share() < 0.05 ? 4 : airframe.battery_share() < 0.15 ? 2 : 1;
  return out;
}

}  // namespace

template <class Message>
void AutopilotEmulator::send(const Message& message) {
  if (output_.size() >= kOutputMax) {
    output_.erase(output_.begin(), output_.begin() + kOutputMax / 2);
  }
  wire::mavlink::append_bytes(
      wire::mavlink::pack(message,
                          {spec_.system_id, wire::mavlink::kComponentAutopilot, next_sequence_++}),
      output_.emplace_back());
}
template void AutopilotEmulator::send(const wire::mavlink::CommandAck&);
template void AutopilotEmulator::send(const wire::mavlink::GpsGlobalOrigin&);
template void AutopilotEmulator::send(const wire::mavlink::ParamValue&);
template void AutopilotEmulator::send(const wire::mavlink::Timesync&);

bool AutopilotEmulator::has_listener() const {
  constexpr Duration kStationLost{2'500'000};
  return !profile_.texts_need_station ||
         (station_heartbeat_ && now_ - *station_heartbeat_ <= kStationLost);
}

void AutopilotEmulator::send_text(const wire::mavlink::Statustext& text) {
  if (has_listener()) {
    send(text);
  }
}

void AutopilotEmulator::send_due() {
  for (const StatusText& text_to_send : controller_.take_texts()) {
    wire::mavlink::Statustext text;
    text.severity = text_to_send.severity;
    const std::size_t room = text.text.size();
    if (text_to_send.text.size() > room) {
      text.id = ++next_text_;  // the text is sent in several chunks
    }
    for (std::size_t begin = 0; begin < text_to_send.text.size(); begin += room) {
      text.text.fill('\0');
      text_to_send.text.copy(text.text.data(), room, begin);
      send_text(text);
      ++text.chunk_seq;
    }
  }
  for (auto& [id, stream] : streams_) {
    if (now_ >= stream.next) {
      stream.next = std::max(stream.next + stream.interval, now_);
      send_stream_message(id);
    }
  }
}

// Long function: it contains one case for each message.
void AutopilotEmulator::send_stream_message(std::uint32_t message_id) {
  const Airframe& airframe = controller_.airframe();
  const auto boot_ms = static_cast<std::uint32_t>((now_ - boot_).count() / 1000);
  switch (message_id) {
    case wire::mavlink::Heartbeat::kMessage.id: {
      wire::mavlink::Heartbeat out;
      out.custom_mode = controller_.mode();
      out.type = kQuadrotor;
      out.autopilot = profile_.autopilot_id;
      out.base_mode =
          static_cast<std::uint8_t>(1 | (controller_.is_armed() ? wire::mavlink::kArmedFlag : 0));
      out.system_status = controller_.is_armed() ? wire::mavlink::kStateActive : kStandby;
      out.mavlink_version = 3;
      return send(out);
    }
    case wire::mavlink::Timesync::kMessage.id: {
      wire::mavlink::Timesync out;
      out.ts1 = std::max<std::int64_t>(1, (now_ - boot_).count() * 1000);
      return send(out);
    }
    case wire::mavlink::LocalPositionNed::kMessage.id: {
      const bool is_fed = controller_.has_position(now_);
      if (!is_fed && profile_.needs_origin) {
        return;
      }
      // Without poses, PX4 reports the position at power-up.
      const Eigen::Vector3d position_m =
          is_fed ? controller_.estimator().position_m() : Eigen::Vector3d::Zero();
      const Eigen::Vector3d velocity_mps =
          is_fed ? airframe.velocity_mps() : Eigen::Vector3d::Zero();
      return send(wire::mavlink::LocalPositionNed{
          {boot_ms, f32(position_m.x()), f32(position_m.y()), f32(position_m.z()),
           f32(velocity_mps.x()), f32(velocity_mps.y()), f32(velocity_mps.z())}});
    }
    case wire::mavlink::Attitude::kMessage.id: {
      const Eigen::Matrix3d R = airframe.local_from_body().toRotationMatrix();
      return send(wire::mavlink::Attitude{boot_ms, f32(std::atan2(R(2, 1), R(2, 2))),
                                          f32(-std::asin(std::clamp(R(2, 0), -1.0, 1.0))),
                                          f32(std::atan2(R(1, 0), R(0, 0))), 0.0F, 0.0F,
                                          f32(airframe.yaw_rate_radps())});
    }
    case wire::mavlink::EstimatorStatus::kMessage.id: {
      wire::mavlink::EstimatorStatus out;
      out.time_usec = static_cast<std::uint64_t>((now_ - boot_).count());
      out.flags = controller_.estimator_flags(now_);
      return send(out);
    }
    case wire::mavlink::EkfStatusReport::kMessage.id: {
      wire::mavlink::EkfStatusReport out;
      out.flags = controller_.estimator_flags(now_);
      return send(out);
    }
    case wire::mavlink::ExtendedSysState::kMessage.id:
      return send(wire::mavlink::ExtendedSysState{0, controller_.landed_state()});
    case wire::mavlink::BatteryStatus::kMessage.id:
      return send(battery_status(airframe, spec_.battery));
    case wire::mavlink::SysStatus::kMessage.id: {
      wire::mavlink::SysStatus out;
      out.voltage_battery = battery_status(airframe, spec_.battery).voltages[0];
      out.battery_remaining = battery_status(airframe, spec_.battery).battery_remaining;
      return send(out);
    }
    default:
      return;  // the request is accepted, but the message is never sent
  }
}

}  // namespace vantage::sim
