#include "drivers/safety/mocap_source.hpp"

#include <cmath>

namespace vantage::drivers {

bool MocapSource::is_current(Time stamp, Duration ahead, Time now) {
  return std::abs(to_seconds(now + ahead - stamp)) <= kFreshS;
}

void MocapSource::record_frame(const models::MocapFrame& frame, Time now) {
  received_at_ = now;
  number_ = frame.frame_number;
  if (is_current(frame.stamp.time, {}, now)) {
    ahead_ = {};
  } else if (!is_current(frame.stamp.time, ahead_, now)) {
    ahead_ = frame.stamp.time - now;
  }
}

MocapSource::Standing MocapSource::judge(const models::MocapFrame& frame, Time now) {
  const Time stamp = frame.stamp.time;
  if (run_id_ == frame.stamp.run_id) {
    const bool is_continuation =
        frame.frame_number > number_ && frame.frame_number - number_ <= kLostMax;
    if (!is_continuation && !is_current(stamp, {}, now) && !is_current(stamp, ahead_, now)) {
      ++other_time_;
      other_time_received_at_ = now;
      return Standing::kRefused;
    }
    record_frame(frame, now);
    return Standing::kAccepted;
  }
  if (!is_current(stamp, {}, now)) {
    ++other_time_;
    other_time_received_at_ = now;
    return Standing::kRefused;
  }
  if (run_id_) {
    other_received_at_ = now;
  }
  if (run_id_ && to_seconds(now - received_at_) <= kSilentS) {
    ++others_refused_;
    return Standing::kRefused;
  }
  return Standing::kCandidate;
}

void MocapSource::confirm(const models::MocapFrame& frame, Time now) {
  takeovers_ += run_id_ ? 1 : 0;
  run_id_ = frame.stamp.run_id;
  ahead_ = {};
  other_received_at_.reset();
  record_frame(frame, now);
}

const char* MocapSource::refusal_message(Time now) const {
  const auto is_recent = [now](const std::optional<Time>& received_at) {
    return received_at && to_seconds(now - *received_at) <= kFreshS;
  };
  return is_recent(other_received_at_) ? "messages from a second VICON source are rejected"
         : is_recent(other_time_received_at_)
             ? "VICON messages from another clock or a log are rejected"
             : nullptr;
}

void MocapSource::count(std::vector<models::NamedCount>& out) const {
  out.push_back({"mocap.other_source", others_refused_});
  out.push_back({"mocap.other_time", other_time_});
  out.push_back({"mocap.takeovers", takeovers_});
}

}  // namespace vantage::drivers
