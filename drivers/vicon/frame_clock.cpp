#include "drivers/vicon/frame_clock.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::drivers::vicon {
namespace {

/// Largest difference between the minimum jitters of two intervals. Divided by a time span, it
/// gives the relative error of a tick period.
constexpr double kJitter_s = 0.003;
/// A tick period estimated from data of this duration is final.
constexpr double kLearned_s = 10.0;
constexpr double kFitPeriod_s = 1.0;
/// If frames arrive faster than the tick period by more than this ratio for kBlock_s, the period is
/// estimated again.
constexpr double kFaster = 0.01;
constexpr double kBlock_s = 1.0;
/// Longest gap between frames over which the line (see FrameClock) rises by the period's error.
constexpr double kDriftGap_s = 0.1;
constexpr double kLate_s = 0.02;
/// A queue counts as not emptying if the lateness has not decreased by kEmpties_s within kStands_s
/// and kStandsFrames frames.
constexpr double kEmpties_s = 0.02;
constexpr double kStands_s = 0.05;
constexpr int kStandsFrames = 5;
/// An echo with a longer round trip counts as slow. Half of this time is assumed to be the delay
/// without a queue.
constexpr double kSlowEcho_s = 0.1;
constexpr Duration kSlowFor = std::chrono::seconds(2);
/// After an echo with a shorter round trip, frames have not waited for long.
constexpr double kFastEcho_s = 0.05;
constexpr double kSamePeriod = 0.01;
constexpr double kOtherPeriod = 0.003;

double tick_period_s(const FrameMark& from, const FrameMark& to) {
  return (to.arrival_s - from.arrival_s) / static_cast<double>(to.tick - from.tick);
}

}  // namespace

void FrameClock::begin(const FrameMark& now, double stated_tick_s) {
  restart();
  last_ = now;
  line_s_ = now.arrival_s;
  tick_s_ = stated_s_ = stated_tick_s;
  is_learned_ = stated_tick_s <= 0.0;
  fit_.add(now);
}

Duration FrameClock::lateness(const FrameTiming& frame, Duration arrival, Duration latency) {
  const FrameMark now{frame.tick, to_seconds(arrival - latency)};
  if (!last_ || now.tick < last_->tick) {
    begin(now, frame.stated_tick_s);
    if (!frame.sent) {
      return {};
    }
  }
  if (frame.stated_tick_s != stated_s_) {
    const double line_s = std::min(line_s_ + now.arrival_s - last_->arrival_s, now.arrival_s);
    begin(now, frame.stated_tick_s);
    line_s_ = line_s;  // a new tick period does not shorten the wait of frames
  }
  const double passed_s = std::clamp(now.arrival_s - last_->arrival_s, 0.0, kDriftGap_s);
  line_s_ += tick_s_ * static_cast<double>(now.tick - last_->tick) + drift_ * passed_s;
  if (frame.pinged) {
    line_s_ = std::max(line_s_, to_seconds(*frame.pinged - latency));
  }
  if (frame.sent) {
    line_s_ = std::min(to_seconds(*frame.sent - latency), now.arrival_s);
  } else if (tick_s_ <= 0.0 || now.arrival_s <= line_s_) {
    line_s_ = now.arrival_s;
  }
  const bool has_new_tick = now.tick > last_->tick;
  last_ = now;
  const double late_s = now.arrival_s - line_s_;
  if (has_new_tick && is_learned_) {
    learn(now, late_s);
  } else if (has_new_tick) {
    check_stated(now);
  }
  is_after_echo_ = false;
  watch_queue(now, late_s);
  return from_seconds(late_s);
}

void FrameClock::learn(const FrameMark& now, double late_s) {
  if (late_s > kLate_s) {
    block_.reset();
    return;
  }
  // If the block's first frame did not wait, the true tick period is at most the period measured
  // over the block.
  if (!block_) {
    block_ = now;
    block_late_s_ = late_s;
  } else if (now.arrival_s - block_->arrival_s >= kBlock_s) {
    const bool is_faster = tick_s_ > 0.0 && block_late_s_ <= kJitter_s &&
                           tick_period_s(*block_, now) < (1.0 - kFaster) * tick_s_;
    block_ = now;
    block_late_s_ = late_s;
    if (is_faster) {
      tick_s_ = 0.0;
      fit_.restart();
      next_fit_s_ = 0.0;
    }
  }
  if (tick_s_ > 0.0 && fit_.span_s() >= kLearned_s) {
    return;
  }
  fit_.add(now);
  const double span_s = fit_.span_s();
  if (span_s < std::max(kLearn_s, next_fit_s_)) {
    return;
  }
  next_fit_s_ = span_s + kFitPeriod_s;
  const auto fitted_s = fit_.tick_s();
  // A later fit may correct an earlier fit within the error of the earlier one; a larger change is
  // caused by a growing queue.
  if (fitted_s && *fitted_s > 0.0 &&
      (tick_s_ <= 0.0 || std::abs(*fitted_s - tick_s_) <= drift_ * tick_s_)) {
    tick_s_ = *fitted_s;
    drift_ = kDrift + kJitter_s / span_s;
  }
}

// Compares the stated tick period with the period measured between two frames after fast echoes.
// Such frames have not waited for long.
void FrameClock::check_stated(const FrameMark& now) {
  if (!is_after_echo_) {
    return;
  }
  if (!echo_mark_) {
    echo_mark_ = now;
    return;
  }
  const double passed_s = now.arrival_s - echo_mark_->arrival_s;
  if (passed_s < kBlock_s || now.tick <= echo_mark_->tick) {
    return;
  }
  const double measured_s = tick_period_s(*echo_mark_, now);
  const double error_s =
      (round_trip_s_ + measured_s) / static_cast<double>(now.tick - echo_mark_->tick);
  const bool is_other = std::abs(measured_s - tick_s_) > error_s + kOtherPeriod * tick_s_;
  const bool is_same = std::abs(measured_s - refuted_tick_s_) < kSamePeriod * measured_s;
  refutations_ = !is_other ? 0 : refutations_ > 0 && is_same ? refutations_ + 1 : 1;
  refuted_tick_s_ = measured_s;
  echo_mark_ = now;
  if (refutations_ * kBlock_s >= kRefuted_s) {
    tick_s_ = measured_s;
    drift_ = kDrift + error_s / measured_s;
    is_learned_ = true;
    fit_.restart();
  }
}

void FrameClock::watch_queue(const FrameMark& now, double late_s) {
  if (late_s <= kLate_s) {
    window_begin_s_.reset();
    is_standing_ = false;
    return;
  }
  const bool empties = window_begin_s_ && late_s < window_late_s_ - kEmpties_s;
  const bool stands = window_begin_s_ && ++window_frames_ >= kStandsFrames &&
                      now.arrival_s - *window_begin_s_ >= kStands_s;
  is_standing_ = !empties && (is_standing_ || stands);
  if (!window_begin_s_ || empties || stands) {
    window_begin_s_ = now.arrival_s;
    window_late_s_ = late_s;
    window_frames_ = 0;
  }
}

void FrameClock::on_echo(Duration sent, Duration arrived) {
  const double round_trip_s = to_seconds(arrived - sent);
  is_after_echo_ = round_trip_s < kFastEcho_s;
  round_trip_s_ = round_trip_s;
  if (round_trip_s < kSlowEcho_s) {
    slow_since_.reset();
    return;
  }
  least_slow_s_ = slow_since_ ? std::min(least_slow_s_, round_trip_s) : round_trip_s;
  slow_since_ = slow_since_ ? slow_since_ : sent;
  if (last_ && sent - *slow_since_ >= kSlowFor) {
    line_s_ = std::min(line_s_, last_->arrival_s - (least_slow_s_ - 0.5 * kSlowEcho_s));
  }
}

}  // namespace vantage::drivers::vicon
