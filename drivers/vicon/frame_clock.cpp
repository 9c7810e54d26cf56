#include "drivers/vicon/frame_clock.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::drivers::vicon {
namespace {

constexpr double kBlock_s = 1.0;
constexpr int kBlockFrames = 10;
/// Two stretches whose paces differ by less are of one pace.
constexpr double kSamePace = 0.02;
/// The line rises by so much of the time that passes, for the pace is not known better; but not
/// while nothing comes.
constexpr double kDrift = 0.01;
constexpr double kDriftGap_s = 0.1;
constexpr double kLate_s = 0.02;
/// What has queued comes much faster than it was made.
constexpr double kOwnPace = 0.8;
constexpr int kOwnPaceFrames = 5;
constexpr double kOwnPace_s = 0.05;

}  // namespace

void FrameClock::restart() { *this = {}; }

Duration FrameClock::lateness(std::int64_t tick, Duration arrival) {
  const Mark now{tick, to_seconds(arrival)};
  if (!last_ || now.tick < last_->tick) {
    restart();
    last_ = block_ = now;
    line_s_ = now.arrival_s;
    return {};
  }
  const double passed_s = std::clamp(now.arrival_s - last_->arrival_s, 0.0, kDriftGap_s);
  line_s_ += tick_s_ * static_cast<double>(now.tick - last_->tick) + kDrift * passed_s;
  last_ = now;
  if (tick_s_ <= 0.0 || now.arrival_s <= line_s_ || goes_on_late(now)) {
    line_s_ = now.arrival_s;
  }
  const double late_s = now.arrival_s - line_s_;
  learn(now, late_s > kLate_s);
  return from_seconds(late_s);
}

bool FrameClock::goes_on_late(const Mark& now) {
  if (now.arrival_s - line_s_ <= kLate_s) {
    late_since_.reset();
    return false;
  }
  if (!late_since_) {
    late_since_ = now;
    late_frames_ = 0;
    return false;
  }
  const double passed_s = now.arrival_s - late_since_->arrival_s;
  const double made_s = tick_s_ * static_cast<double>(now.tick - late_since_->tick);
  if (passed_s < kOwnPace * made_s) {
    late_since_ = now;
    late_frames_ = 0;
    return false;
  }
  if (++late_frames_ < kOwnPaceFrames || passed_s < kOwnPace_s) {
    return false;
  }
  late_since_.reset();
  return true;
}

void FrameClock::learn(const Mark& now, bool is_late) {
  ++block_frames_;
  const double passed_s = now.arrival_s - block_.arrival_s;
  if (is_late || passed_s < kBlock_s || block_frames_ < kBlockFrames || now.tick == block_.tick) {
    return;
  }
  const double pace_s = passed_s / static_cast<double>(now.tick - block_.tick);
  if (std::abs(pace_s - block_tick_s_) < kSamePace * pace_s) {
    tick_s_ = 0.5 * (pace_s + block_tick_s_);
  }
  block_tick_s_ = pace_s;
  block_ = now;
  block_frames_ = 0;
}

}  // namespace vantage::drivers::vicon
