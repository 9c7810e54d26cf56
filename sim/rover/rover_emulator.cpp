#include "sim/rover/rover_emulator.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"

namespace vantage::sim {
namespace {

constexpr Duration kStep{5'000};

}  // namespace

RoverEmulator::RoverEmulator(const RoverEmulatorSpec& spec, Time start)
    : spec_(spec), now_(start), battery_share_(spec.battery_share), next_telemetry_(start) {
  state_.world_from_body = spec.start;
}

bool RoverEmulator::is_watchdog_out() const {
  return session_ == 0 || to_seconds(now_ - command_arrival_) > wire::rover::kWatchdogS;
}

void RoverEmulator::advance_to(Time now) {
  while (now_ < now) {
    const Duration dt = std::min(kStep, now - now_);
    now_ += dt;
    step(to_seconds(dt));
  }
}

void RoverEmulator::step(double dt_s) {
  while (!demands_.empty() && demands_.front().effect <= now_) {
    demand_ = demands_.front().command;
    demands_.pop_front();
  }
  const bool obeys = is_driving_ && !is_stopped_ && !has_motor_failed_ && !is_watchdog_out();
  if (!obeys) {
    demands_.clear();
    demand_ = {};
  }
  const Pose2 before = state_.world_from_body;
  state_ = step_rover(state_, demand_, spec_.limits, dt_s);
  Pose2& pose = state_.world_from_body;
  pose.x_m = before.x_m + spec_.grip * (pose.x_m - before.x_m);
  pose.y_m = before.y_m + spec_.grip * (pose.y_m - before.y_m);
  if (state_.speed_mps > 0.0) {
    pose.yaw_rad = wrap_to_pi(pose.yaw_rad + spec_.drift_radps * dt_s);
  }
  battery_share_ = std::max(0.0, battery_share_ - spec_.battery_per_s * dt_s);
}

void RoverEmulator::receive(std::span<const std::uint8_t> datagram, Time now) {
  advance_to(now);
  wire::rover::Command command;
  if (wire::rover::decode(datagram, command) != wire::rover::Verdict::kAccepted ||
      command.robot != spec_.number) {
    ++refused_;
    return;
  }
  // An emergency stop is obeyed from any session, with any delay.
  is_stopped_ = is_stopped_ || (command.flags & wire::rover::kEmergencyStop) != 0;
  const bool takes_over = command.session != session_ && is_watchdog_out();
  const bool is_continuation =
      command.session == session_ && wire::rover::is_after(command.sequence, command_sequence_);
  if (!takes_over && !is_continuation) {
    ++refused_;
    return;
  }
  execute(command, now);
}

void RoverEmulator::execute(const wire::rover::Command& command, Time now) {
  session_ = command.session;
  command_sequence_ = command.sequence;
  command_time_us_ = command.time_us;
  command_arrival_ = now;
  const bool requests_stop = (command.flags & wire::rover::kEmergencyStop) != 0;
  is_driving_ = (command.flags & wire::rover::kDrive) != 0 && !requests_stop;
  if ((command.flags & wire::rover::kReleaseStop) != 0 && !requests_stop && !is_driving_) {
    is_stopped_ = false;
  }
  demands_.push_back(
      {now + from_seconds(spec_.delay_s),
       {static_cast<double>(command.speed_mps), static_cast<double>(command.yaw_rate_radps)}});
}

std::optional<std::array<std::uint8_t, wire::rover::kTelemetryBytes>> RoverEmulator::take_output() {
  if (now_ < next_telemetry_) {
    return std::nullopt;
  }
  next_telemetry_ = now_ + from_seconds(wire::rover::kTelemetryPeriodS);
  wire::rover::Telemetry out;
  out.robot = spec_.number;
  out.boot = spec_.boot;
  out.sequence = telemetry_sequence_++;
  out.session = session_;
  out.command_sequence = command_sequence_;
  out.command_time_us = command_time_us_;
  out.speed_mps = static_cast<float>(state_.speed_mps);
  out.yaw_rate_radps = static_cast<float>(state_.yaw_rate_radps);
  out.battery_share = static_cast<float>(battery_share_);
  const auto bit = [](bool is_set, std::uint32_t flag) { return is_set ? flag : 0U; };
  out.flags = bit(is_driving_ && !is_stopped_ && !is_watchdog_out(), wire::rover::kDriving) |
              bit(is_stopped_, wire::rover::kStopLatched) |
              bit(is_watchdog_out(), wire::rover::kWatchdogOut) |
              bit(has_motor_failed_, wire::rover::kMotorFailed);
  out.refused = static_cast<std::uint32_t>(refused_);
  return wire::rover::encode(out);
}

}  // namespace vantage::sim
