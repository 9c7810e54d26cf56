#include "drivers/quadrotor/telemetry.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/axes.hpp"
#include "drivers/quadrotor/dialect.hpp"
#include "wire/mavlink/constants.hpp"

namespace vantage::drivers {
namespace {

constexpr Duration kHeartbeatAgeMax = std::chrono::milliseconds(2500);
constexpr Duration kEstimatorAgeMax = std::chrono::seconds(2);
constexpr Duration kPositionAgeMax = std::chrono::milliseconds(500);
constexpr Duration kAttitudeAgeMax = std::chrono::milliseconds(500);
constexpr std::size_t kTextsMax = 32;
constexpr std::size_t kTextBytesMax = 500;
constexpr int kWarning = 4;
constexpr std::uint16_t kNoVoltage = 0xFFFF;
constexpr double kVoltageSmoothingS = 5.0;
constexpr Duration kBatteryAgeMax = std::chrono::seconds(10);
constexpr Duration kThrustLossAge = std::chrono::seconds(10);
// Source: ArduCopter, crash_check.cpp: sent once, after the level vehicle has sunk for 1 s at full
// throttle.
constexpr std::string_view kThrustLoss = "Potential Thrust Loss";
constexpr int kSystemBattery = 256;  // source id of SYS_STATUS; ids in BATTERY_STATUS are smaller
// ns; the shortest round trip is increased by this value per exchange, so that clock drift is
// followed.
constexpr std::int64_t kRoundTripForgettingNs = 20'000;

}  // namespace

void Telemetry::take(const wire::mavlink::Frame& frame, Time now) {
  received_at_[frame.message_id] = now;
  if (const auto heartbeat = wire::mavlink::unpack<wire::mavlink::Heartbeat>(frame)) {
    take_heartbeat(*heartbeat, now);
  } else if (const auto state = wire::mavlink::unpack<wire::mavlink::ExtendedSysState>(frame)) {
    landed_state_ = state->landed_state;
  } else if (const auto battery = wire::mavlink::unpack<wire::mavlink::BatteryStatus>(frame)) {
    // Voltages of the cells, or the total in the first entries; 0xFFFF if absent.
    double voltage_mv = 0.0;
    for (const std::uint16_t part_mv : battery->voltages) {
      voltage_mv += part_mv == kNoVoltage ? 0.0 : part_mv;
    }
    take_battery(battery->id, battery->battery_remaining, voltage_mv / 1000.0, now);
  } else if (const auto system = wire::mavlink::unpack<wire::mavlink::SysStatus>(frame)) {
    take_battery(kSystemBattery, system->battery_remaining,
                 system->voltage_battery == kNoVoltage ? 0.0 : system->voltage_battery / 1000.0,
                 now);
    // PX4 reports errors of motors_escs here, including motors that its failure detector reports as
    // failed. ArduPilot always reports motor outputs as healthy.
    // Source: PX4, src/modules/mavlink/streams/SYS_STATUS.hpp.
    are_motors_unhealthy_ =
        (system->onboard_control_sensors_present & system->onboard_control_sensors_enabled &
         ~system->onboard_control_sensors_health & wire::mavlink::kSensorMotorOutputs) != 0;
  } else if (const auto px4 = wire::mavlink::unpack<wire::mavlink::EstimatorStatus>(frame)) {
    estimator_flags_ = px4->flags;
  } else if (const auto ardupilot = wire::mavlink::unpack<wire::mavlink::EkfStatusReport>(frame)) {
    estimator_flags_ = ardupilot->flags;
  } else if (const auto position = wire::mavlink::unpack<wire::mavlink::LocalPositionNed>(frame)) {
    const Eigen::Vector3d local_m(position->x, position->y, position->z);
    const Eigen::Vector3d local_mps(position->vx, position->vy, position->vz);
    if (local_m.allFinite() && local_mps.allFinite()) {
      position_time_ = now;
      position_world_m_ = convert_axes(local_m);
      velocity_world_mps_ = convert_axes(local_mps);
    }
  } else if (const auto attitude = wire::mavlink::unpack<wire::mavlink::Attitude>(frame)) {
    const double cosine = std::cos(static_cast<double>(attitude->roll)) *
                          std::cos(static_cast<double>(attitude->pitch));
    const double yaw_rad = static_cast<double>(attitude->yaw);
    if (std::isfinite(cosine) && std::isfinite(yaw_rad) && std::isfinite(attitude->yawspeed)) {
      attitude_time_ = now;
      tilt_rad_ = std::acos(cosine);
      world_from_body_ = convert_axes(
          Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(static_cast<double>(attitude->pitch), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(static_cast<double>(attitude->roll), Eigen::Vector3d::UnitX()));
      yaw_rate_radps_ = convert_yaw(static_cast<double>(attitude->yawspeed));
    }
  } else if (frame.message_id == wire::mavlink::GpsGlobalOrigin::kMessage.id) {
    has_origin_ = true;
  } else if (const auto timesync = wire::mavlink::unpack<wire::mavlink::Timesync>(frame)) {
    take_timesync(*timesync, now);
  } else if (const auto text = wire::mavlink::unpack<wire::mavlink::Statustext>(frame)) {
    take_text(*text, now);
  }
}

void Telemetry::take_heartbeat(const wire::mavlink::Heartbeat& heartbeat, Time now) {
  if (heartbeat_time_ && now - *heartbeat_time_ > kHeartbeatAgeMax) {
    ++reconnections_;
    has_origin_ = false;
    clock_offset_ns_.reset();
  }
  heartbeat_time_ = now;
  is_armed_ = (heartbeat.base_mode & wire::mavlink::kArmedFlag) != 0;
  mode_ = heartbeat.custom_mode;
  autopilot_ = heartbeat.autopilot;
}

void Telemetry::take_battery(int source, std::int8_t remaining_percent, double voltage_v,
                             Time now) {
  Battery& battery = batteries_[source];
  std::optional<double> share;
  if (remaining_percent >= 0 && remaining_percent <= 100) {
    share = remaining_percent / 100.0;
  }
  if (battery_ && voltage_v > 0.0) {
    const double cell_v = voltage_v / battery_->cells;
    const double newest =
        std::clamp((cell_v - battery_->empty_v) / (battery_->full_v - battery_->empty_v), 0.0, 1.0);
    const double elapsed_s = std::max(0.0, to_seconds(now - battery.time));
    const double weight = battery.rest_share ? -std::expm1(-elapsed_s / kVoltageSmoothingS) : 1.0;
    const double before = battery.rest_share.value_or(0.0);
    battery.rest_share = before + weight * (newest - before);
    share = share ? std::min(*share, *battery.rest_share) : *battery.rest_share;
  }
  if (!share) {
    return;
  }
  battery.share = share;
  battery.time = battery_time_.emplace(now);
  battery_share_ = share;
  for (const auto& [id, each] : batteries_) {
    if (each.share && now - each.time <= kBatteryAgeMax) {
      battery_share_ = std::min(*battery_share_, *each.share);
    }
  }
}

void Telemetry::take_timesync(const wire::mavlink::Timesync& reply, Time now) {
  const std::int64_t now_ns = to_utime(now) * 1000;
  if (reply.tc1 == 0 || reply.ts1 > now_ns || reply.ts1 < now_ns - 1'000'000'000) {
    return;  // ignored: a request, or a reply without a request in the last second
  }
  const std::int64_t round_trip_ns = now_ns - reply.ts1;
  if (!clock_offset_ns_ || round_trip_ns <= round_trip_best_ns_) {
    round_trip_best_ns_ = round_trip_ns;
    clock_offset_ns_ = reply.tc1 - (reply.ts1 + round_trip_ns / 2);
  } else {
    round_trip_best_ns_ += kRoundTripForgettingNs;
  }
}

void Telemetry::take_text(const wire::mavlink::Statustext& message, Time now) {
  const auto end = std::find(message.text.begin(), message.text.end(), '\0');
  std::string text(message.text.begin(), end);
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  const bool is_continued =
      message.id != 0 && message.chunk_seq > 0 && message.id == text_id_ && !texts_.empty();
  text_id_ = message.id;
  if (is_continued) {
    if (texts_.back().text.size() + text.size() <= kTextBytesMax) {
      texts_.back().text += text;
    }
    return;
  }
  texts_.push_back({now, message.severity, std::move(text)});
  if (texts_.size() > kTextsMax) {
    texts_.pop_front();
  }
}

bool Telemetry::is_connected(Time now) const {
  return heartbeat_time_ && now - *heartbeat_time_ <= kHeartbeatAgeMax;
}

bool Telemetry::is_on_ground() const {
  return landed_state_ == wire::mavlink::landed::kUnknown
             ? !is_armed_
             : landed_state_ == wire::mavlink::landed::kOnGround;
}

std::optional<std::uint16_t> Telemetry::estimator_flags(Time now) const {
  const std::uint32_t id = dialect_ == models::AutopilotDialect::kPx4
                               ? wire::mavlink::EstimatorStatus::kMessage.id
                               : wire::mavlink::EkfStatusReport::kMessage.id;
  const auto time = received_at(id);
  return time && now - *time <= kEstimatorAgeMax ? std::optional(estimator_flags_) : std::nullopt;
}

std::optional<Eigen::Vector3d> Telemetry::position_world_m(Time now) const {
  return position_time_ && now - *position_time_ <= kPositionAgeMax
             ? std::optional(position_world_m_)
             : std::nullopt;
}

bool Telemetry::has_attitude(Time now) const {
  return attitude_time_ && now - *attitude_time_ <= kAttitudeAgeMax;
}

std::optional<Time> Telemetry::received_at(std::uint32_t message_id) const {
  const auto found = received_at_.find(message_id);
  return found == received_at_.end() ? std::nullopt : std::optional(found->second);
}

bool Telemetry::has_motor_fault(Time now) const {
  if (dialect_ == models::AutopilotDialect::kPx4) {
    return are_motors_unhealthy_;
  }
  return std::any_of(texts_.begin(), texts_.end(), [now](const AutopilotText& text) {
    return text.text.starts_with(kThrustLoss) && now - text.time <= kThrustLossAge;
  });
}

std::optional<std::string> Telemetry::newest_warning(Time now, Duration age) const {
  const auto found = std::find_if(texts_.rbegin(), texts_.rend(), [&](const AutopilotText& text) {
    return text.severity <= kWarning && now - text.time <= age;
  });
  return found == texts_.rend() ? std::nullopt : std::optional(found->text);
}

}  // namespace vantage::drivers
