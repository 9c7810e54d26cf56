#include "drivers/safety/mocap_clock.hpp"

#include <algorithm>

namespace vantage::drivers {
namespace {

constexpr double kLatencyMaxS = 1.0;  // beyond it, clocks were set, not frames late
constexpr std::int64_t kFramesMax = 100;

}  // namespace

bool MocapClock::on_frame(Time stamp, Time arrival, std::int64_t number) {
  const double raw_s = to_seconds(arrival - stamp);
  const double as_before_s = raw_s - apart_s_;
  const bool goes_on = as_before_s >= 0.0 && as_before_s <= kLatencyMaxS;
  const std::int64_t frames = number - number_;
  const bool counts = has_frame_ && frames >= 1 && frames <= kFramesMax;
  if (goes_on) {
    const double period_s = to_seconds(stamp - stamp_) / static_cast<double>(counts ? frames : 1);
    period_s_ = counts && period_s > 0.0 && period_s < kLatencyMaxS ? period_s : period_s_;
    latency_s_ = as_before_s;
  } else {
    const double gap_s = has_frame_ ? to_seconds(arrival - arrival_) : 0.0;
    const double due_s = counts ? period_s_ * static_cast<double>(frames) : 0.0;
    latency_s_ = std::clamp(latency_s_ + gap_s - due_s, 0.0, kLatencyMaxS);
    apart_s_ = raw_s - latency_s_;
  }
  has_frame_ = true;
  stamp_ = stamp;
  arrival_ = arrival;
  number_ = number;
  return goes_on;
}

}  // namespace vantage::drivers
