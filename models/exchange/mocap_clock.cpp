#include "models/exchange/mocap_clock.hpp"

#include <algorithm>
#include <chrono>

namespace vantage::models {
namespace {

/// Largest latency from the publisher to this process. A larger value means that a clock was set to
/// another time.
constexpr Duration kLatencyMax = std::chrono::seconds(1);
/// Largest latency that a frame may state; a frame with a larger value has an invalid arrival time.
constexpr Duration kStatedMax = std::chrono::seconds(20);
constexpr std::int64_t kFramesMax = 100;

}  // namespace

bool MocapClock::on_frame(const MocapFrame& frame, Time now) {
  if (has_frame_ && frame.stamp.run_id != run_id_) {
    *this = {};
  }
  run_id_ = frame.stamp.run_id;
  const Duration stated = frame.arrival - frame.stamp.time;
  const bool is_sensible = stated >= Duration{} && stated <= kStatedMax;
  return on_frame(frame.stamp.time, now, frame.frame_number, is_sensible ? stated : Duration{});
}

std::shared_ptr<const MocapFrame> MocapClock::on_our_clock(
    const std::shared_ptr<const MocapFrame>& frame, Time now) {
  static_cast<void>(on_frame(*frame, now));
  const Duration shift = captured() - frame->stamp.time;
  if (shift == Duration{}) {
    return frame;
  }
  auto moved = std::make_shared<MocapFrame>(*frame);
  moved->stamp.time += shift;
  moved->arrival += shift;
  return moved;
}

bool MocapClock::on_frame(Time stamp, Time arrival, std::int64_t number, Duration stated) {
  const Duration raw = arrival - stamp;
  const Duration latency_by_offset = raw - offset_;
  const Duration latency_max = kLatencyMax + stated;
  const std::int64_t frames = number - number_;
  const bool counts = has_frame_ && frames >= 1 && frames <= kFramesMax;
  // One frame alone cannot distinguish latency from a clock set back by less than a second.
  const bool was_set_back = counts && stamp + stated < publisher_arrival_;
  const bool is_continuous =
      latency_by_offset >= Duration{} && latency_by_offset <= latency_max && !was_set_back;
  if (is_continuous) {
    const Duration period = (stamp - stamp_) / (counts ? frames : 1);
    period_ = counts && period > Duration{} && period < kLatencyMax ? period : period_;
    latency_ = latency_by_offset;
  } else {
    const Duration gap = has_frame_ ? arrival - arrival_ : Duration{};
    const Duration due = counts ? period_ * frames : Duration{};
    latency_ = std::clamp(latency_ + gap - due, Duration{}, latency_max);
    offset_ = raw - latency_;
  }
  has_frame_ = true;
  stamp_ = stamp;
  publisher_arrival_ = stamp + stated;
  arrival_ = arrival;
  number_ = number;
  return is_continuous;
}

}  // namespace vantage::models
