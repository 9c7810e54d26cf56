#include "drivers/rover/link.hpp"

#include <algorithm>
#include <string>

#include "drivers/safety/inputs.hpp"

namespace vantage::drivers {

RoverLink::RoverLink(std::uint32_t number, std::uint32_t session)
    : number_(number), session_(std::max(1U, session)) {}

std::array<std::uint8_t, wire::rover::kCommandBytes> RoverLink::command(
    const models::UnicycleControl& control, std::uint32_t flags, Time now) {
  wire::rover::Command out;
  out.robot = number_;
  out.session = session_;
  out.sequence = ++sequence_;
  out.time_us = to_utime(now);
  out.speed_mps = static_cast<float>(control.speed_mps);
  out.yaw_rate_radps = static_cast<float>(control.yaw_rate_radps);
  out.flags = flags;
  return wire::rover::encode(out);
}

bool RoverLink::receive(std::span<const std::uint8_t> datagram, Time now) {
  wire::rover::Telemetry received;
  const wire::rover::Verdict verdict = wire::rover::decode(datagram, received);
  ++verdicts_[static_cast<std::size_t>(verdict)];
  if (verdict != wire::rover::Verdict::kAccepted) {
    return false;
  }
  if (received.robot != number_) {
    ++misaddressed_;
    return false;
  }
  const bool is_same_boot = has_telemetry_ && received.boot == telemetry_.boot;
  if (is_same_boot && !wire::rover::is_after(received.sequence, telemetry_.sequence)) {
    ++late_;
    return false;
  }
  restarts_ += has_telemetry_ && !is_same_boot ? 1 : 0;
  has_telemetry_ = true;
  telemetry_ = received;
  received_at_ = now;
  // True if this session has sent the reported command.
  const bool was_sent =
      received.session == session_ && !wire::rover::is_after(received.command_sequence, sequence_);
  const Time sent = from_utime(received.command_time_us);
  if (was_sent && sent <= now && (!has_taken_command_ || sent > taken_command_sent_at_)) {
    has_taken_command_ = true;
    taken_command_sent_at_ = sent;
  }
  return true;
}

double RoverLink::receive_age_s(Time now) const {
  return has_telemetry_ ? to_seconds(now - received_at_) : kNever;
}

double RoverLink::taken_command_age_s(Time now) const {
  return has_taken_command_ ? to_seconds(now - taken_command_sent_at_) : kNever;
}

bool RoverLink::is_ours() const {
  return telemetry_.session == 0 || telemetry_.session == session_ ||
         has_flag(wire::rover::kWatchdogOut);
}

void RoverLink::count(std::vector<models::NamedCount>& out) const {
  for (std::size_t i = 1; i < wire::rover::kVerdicts; ++i) {
    out.push_back(
        {std::string("rover.") + wire::rover::name_of(static_cast<wire::rover::Verdict>(i)),
         verdicts_[i]});
  }
  out.push_back({"rover.misaddressed", misaddressed_});
  out.push_back({"rover.late", late_});
  out.push_back({"rover.restarts", restarts_});
  out.push_back({"rover.commands_refused", static_cast<std::int64_t>(telemetry_.refused)});
}

}  // namespace vantage::drivers
