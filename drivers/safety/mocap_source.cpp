#include "drivers/safety/mocap_source.hpp"

#include <cmath>

namespace vantage::drivers {

bool MocapSource::is_of_now(Time stamp, Duration ahead, Time now) {
  return std::abs(to_seconds(now + ahead - stamp)) <= kFreshS;
}

void MocapSource::hear(const models::MocapFrame& frame, Time now) {
  heard_ = now;
  number_ = frame.frame_number;
  if (is_of_now(frame.stamp.time, {}, now)) {
    ahead_ = {};
  } else if (!is_of_now(frame.stamp.time, ahead_, now)) {
    ahead_ = frame.stamp.time - now;
  }
}

MocapSource::Standing MocapSource::judge(const models::MocapFrame& frame, Time now) {
  const Time stamp = frame.stamp.time;
  if (run_id_ == frame.stamp.run_id) {
    const bool goes_on = frame.frame_number > number_ && frame.frame_number - number_ <= kGoesOnMax;
    if (!goes_on && !is_of_now(stamp, {}, now) && !is_of_now(stamp, ahead_, now)) {
      ++other_time_;
      other_time_heard_ = now;
      return Standing::kRefused;
    }
    hear(frame, now);
    return Standing::kBelieved;
  }
  if (!is_of_now(stamp, {}, now)) {
    ++other_time_;
    other_time_heard_ = now;
    return Standing::kRefused;
  }
  if (run_id_) {
    other_heard_ = now;
  }
  if (run_id_ && to_seconds(now - heard_) <= kSilentS) {
    ++others_refused_;
    return Standing::kRefused;
  }
  return Standing::kCandidate;
}

void MocapSource::confirm(const models::MocapFrame& frame, Time now) {
  takeovers_ += run_id_ ? 1 : 0;
  run_id_ = frame.stamp.run_id;
  ahead_ = {};
  other_heard_.reset();
  hear(frame, now);
}

const char* MocapSource::complaint(Time now) const {
  const auto is_recent = [now](const std::optional<Time>& heard) {
    return heard && to_seconds(now - *heard) <= kFreshS;
  };
  return is_recent(other_heard_)        ? "messages from a second VICON source are rejected"
         : is_recent(other_time_heard_) ? "VICON messages from another clock or a log are rejected"
                                        : nullptr;
}

void MocapSource::count(std::vector<models::NamedCount>& out) const {
  out.push_back({"mocap.other_source", others_refused_});
  out.push_back({"mocap.other_time", other_time_});
  out.push_back({"mocap.takeovers", takeovers_});
}

}  // namespace vantage::drivers
