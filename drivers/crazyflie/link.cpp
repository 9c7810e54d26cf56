#include "drivers/crazyflie/link.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/angle.hpp"
#include "core/pose.hpp"
#include "models/exchange/counts.hpp"
#include "wire/crtp/system.hpp"

namespace vantage::drivers {
namespace {

namespace crtp = wire::crtp;
using crtp::Packet;

constexpr Duration kSearchPeriod = std::chrono::milliseconds(100);
constexpr Duration kSilence = std::chrono::seconds(1);
constexpr double kTurnedRad = 0.5;  // rad; a larger yaw error on the ground is not noise
constexpr Duration kSettling = std::chrono::seconds(2);
// longest time without log data before the log is set up again
constexpr Duration kLogSilence = std::chrono::milliseconds(700);

}  // namespace

bool CrazyflieLink::receive(std::span<const std::uint8_t> bytes, Time now) {
  const auto packet = crtp::decode(bytes);
  if (!packet) {
    ++undecoded_;
    return false;
  }
  received_at_ = now;
  if (!crtp::is_null(*packet)) {
    ++packets_;
    take(*packet, now);
  }
  return true;
}

void CrazyflieLink::take(const Packet& packet, Time now) {
  if (const auto info = crtp::decode_info_reply(packet)) {
    telemetry_.take_info(*info, now);
  } else if (const auto protocol = crtp::decode_protocol_reply(packet)) {
    protocol_ = protocol;
  } else if (const auto data = crtp::decode_log_data(packet)) {
    if (phase_ == Phase::kReady || phase_ == Phase::kSetUp) {
      telemetry_.take(*data, set_up_.has_battery(), now);
    }
  } else if (const auto reply = crtp::decode_high_level_reply(packet)) {
    high_level_ = reply;
    high_level_at_ = now;
  } else if (const auto text = crtp::decode_console(packet)) {
    console_ = *text;
  } else {
    parameters_.receive(packet, *cache_);
    logs_.receive(packet, *cache_);
    if (phase_ == Phase::kSetUp) {
      set_up_.receive(packet);
    }
  }
}

bool CrazyflieLink::is_connected(Time now) const {
  return received_at_ && now - *received_at_ <= kSilence;
}

bool CrazyflieLink::is_ready(Time now) const {
  return phase_ == Phase::kReady && is_connected(now) && telemetry_.has_state(now) &&
         telemetry_.has_info(now);
}

void CrazyflieLink::search(Time now) {
  if (now >= next_search_) {
    next_search_ = now + kSearchPeriod;
    output_.push_back(crtp::platform_request(crtp::PlatformRequest::kProtocol));
    output_.push_back(crtp::info_request());
  }
  if (is_connected(now) && protocol_ && *protocol_ >= crtp::kProtocolMin &&
      telemetry_.has_info(now)) {
    ++connections_;
    parameters_.restart();
    logs_.restart();
    phase_ = Phase::kParameterTable;
  }
}

void CrazyflieLink::tick(Time now) {
  if (phase_ != Phase::kSearch && !is_connected(now)) {
    phase_ = Phase::kSearch;
    protocol_.reset();
  }
  switch (phase_) {
    case Phase::kSearch:
      search(now);
      return;
    case Phase::kParameterTable:
      parameters_.tick(now, output_);
      phase_ = parameters_.is_complete() ? Phase::kLogTable : phase_;
      return;
    case Phase::kLogTable:
      logs_.tick(now, output_);
      if (!logs_.is_complete()) {
        return;
      }
      phase_ = Phase::kSetUp;
      set_up_.begin(parameters_, logs_, !telemetry_.has(crtp::info::kFlying), start_);
      return;
    case Phase::kSetUp:
      if (const auto request = set_up_.tick(now)) {
        output_.push_back(*request);
      }
      if (set_up_.is_done()) {
        phase_ = Phase::kReady;
        phase_since_ = now;
      }
      return;
    case Phase::kReady: {
      // The vehicle deletes its log blocks after one second of radio silence.
      const Time newest = std::min(telemetry_.state_at().value_or(phase_since_),
                                   telemetry_.info_at().value_or(phase_since_));
      if (now - std::max(newest, phase_since_) > kLogSilence) {
        phase_ = Phase::kSetUp;
        set_up_.begin(parameters_, logs_, false, start_);
      } else if (is_estimate_turned(now) && now - phase_since_ > kSettling) {
        phase_ = Phase::kSetUp;
        set_up_.begin(parameters_, logs_, true, start_);
      }
      return;
    }
  }
}

bool CrazyflieLink::is_estimate_turned(Time now) const {
  if (!start_ || !telemetry_.has_info(now) || telemetry_.has(crtp::info::kFlying) ||
      !telemetry_.has_attitude(now)) {
    return false;
  }
  Pose3 estimate;
  estimate.rotation = telemetry_.world_from_body();
  return std::abs(wrap_to_pi(flatten(estimate).yaw_rad - flatten(*start_).yaw_rad)) > kTurnedRad;
}

void CrazyflieLink::send(const std::optional<Packet>& packet) {
  if (packet) {
    output_.push_back(*packet);
  } else {
    ++encodings_refused_;
  }
}

std::vector<crtp::Encoded> CrazyflieLink::take_output() {
  std::vector<crtp::Encoded> out(output_.size());
  std::ranges::transform(output_, out.begin(),
                         [](const Packet& packet) { return crtp::encode(packet); });
  output_.clear();
  return out;
}

std::optional<std::string> CrazyflieLink::fault(Time now) const {
  if (!is_connected(now)) {
    return "no packet received from the vehicle: check its power and its address";
  }
  if (protocol_ && *protocol_ < crtp::kProtocolMin) {
    return "the vehicle speaks CRTP protocol " + std::to_string(*protocol_) + ", required is " +
           std::to_string(crtp::kProtocolMin) + ": update its firmware";
  }
  if (set_up_.fault()) {
    return set_up_.fault();
  }
  switch (phase_) {
    case Phase::kSearch:
      return "waiting for the vehicle's version";
    case Phase::kParameterTable:
      return "reading the table of parameters: " + std::to_string(parameters_.received()) + " of " +
             std::to_string(parameters_.size());
    case Phase::kLogTable:
      return "reading the table of log variables: " + std::to_string(logs_.received()) + " of " +
             std::to_string(logs_.size());
    case Phase::kSetUp:
      return "setting up the vehicle";
    case Phase::kReady:
      break;
  }
  if (!is_ready(now)) {
    return "no log data received from the vehicle";
  }
  const CrazyflieTelemetry& report = telemetry_;
  if (report.has(crtp::info::kLocked)) {
    return "the vehicle is locked: restart it";
  }
  if (report.has(crtp::info::kCrashed)) {
    return "the vehicle has crashed: put it upright and restart it";
  }
  if (report.has(crtp::info::kDeckFault)) {
    return "the vehicle reports a faulty expansion deck";
  }
  return std::nullopt;
}

std::optional<std::uint8_t> CrazyflieLink::high_level_error(crtp::HighLevelCommand command,
                                                            Time sent) const {
  const bool is_answer = high_level_ && high_level_at_ >= sent &&
                         high_level_->command == static_cast<std::uint8_t>(command);
  return is_answer ? std::optional(high_level_->error) : std::nullopt;
}

std::vector<models::NamedCount> CrazyflieLink::counters() const {
  return models::nonzero({{"crazyflie.packets", packets_},
                          {"crazyflie.undecoded", undecoded_},
                          {"crazyflie.encodings_refused", encodings_refused_},
                          {"crazyflie.connections", connections_}});
}

}  // namespace vantage::drivers
