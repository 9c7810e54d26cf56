#include "logs/play/play_schedule.hpp"

#include <algorithm>
#include <cmath>

#include "core/saturated_time.hpp"

namespace vantage::logs {
namespace {

constexpr double kNsPerUs = 1e3;
constexpr double kAheadMax_ns = 4e18;  ///< ns; 127 years, larger values would overflow

}  // namespace

Time PlaySchedule::position(std::int64_t now_ns) const {
  if (is_paused_) {
    return position_;
  }
  const double passed_us = static_cast<double>(now_ns - since_ns_) / kNsPerUs * speed_;
  return saturated_sum(position_, Duration{std::llround(passed_us)});
}

std::int64_t PlaySchedule::due_ns(Time time) const {
  const double ahead_us = static_cast<double>((time - position_).count()) / speed_;
  return since_ns_ + std::llround(std::clamp(ahead_us * kNsPerUs, -kAheadMax_ns, kAheadMax_ns));
}

void PlaySchedule::resume(std::int64_t now_ns) {
  if (is_paused_) {
    since_ns_ = now_ns;
    is_paused_ = false;
  }
}

void PlaySchedule::pause(std::int64_t now_ns) {
  position_ = position(now_ns);
  is_paused_ = true;
}

void PlaySchedule::seek(Time position, std::int64_t now_ns) {
  position_ = position;
  since_ns_ = now_ns;
}

void PlaySchedule::set_speed(double speed, std::int64_t now_ns) {
  position_ = position(now_ns);
  since_ns_ = now_ns;
  speed_ = speed;
}

}  // namespace vantage::logs
