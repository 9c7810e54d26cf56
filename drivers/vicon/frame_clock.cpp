#include "drivers/vicon/frame_clock.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::drivers::vicon {
namespace {

constexpr double kBlock_s = 1.0;
constexpr int kBlockFrames = 10;
/// The first two stretches have one pace if they differ by less.
constexpr double kSamePace = 0.02;
/// Once the pace is known, a stretch refines it if it differs by less. A slower stretch is a queue
/// that grows, or a server that has changed its rate: a new connection decides.
constexpr double kRefinesPace = 0.003;
constexpr double kRefineGain = 0.1;
/// The line does not rise over a longer gap between two frames.
constexpr double kDriftGap_s = 0.1;
constexpr double kLate_s = 0.02;
/// A queue stands if the lateness has not fallen by kEmpties_s in this time and these frames.
constexpr double kEmpties_s = 0.02;
constexpr double kStands_s = 0.05;
constexpr int kStandsFrames = 5;
/// A server may take so long to answer a ping.
constexpr double kEchoSlack_s = 0.02;
constexpr double kUsualRoundTrip_s = 0.05;

}  // namespace

void FrameClock::restart() { *this = {}; }

Duration FrameClock::lateness(std::int64_t tick, Duration arrival, double stated_tick_s) {
  const Mark now{tick, to_seconds(arrival)};
  if (!last_ || now.tick < last_->tick) {
    restart();
    last_ = block_ = now;
    line_s_ = now.arrival_s;
    tick_s_ = stated_s_ = stated_tick_s;
    return {};
  }
  if (stated_tick_s != stated_s_) {
    tick_s_ = stated_s_ = stated_tick_s;
    is_refuted_ = false;
    block_ = now;
    block_frames_ = 0;
    block_tick_s_ = 0.0;
  }
  const double passed_s = std::clamp(now.arrival_s - last_->arrival_s, 0.0, kDriftGap_s);
  line_s_ += tick_s_ * static_cast<double>(now.tick - last_->tick) + kDrift * passed_s;
  last_ = now;
  if (tick_s_ <= 0.0 || now.arrival_s <= line_s_) {
    line_s_ = now.arrival_s;
  }
  if (stated_s_ <= 0.0 || is_refuted_) {
    learn(now);
  }
  const double late_s = now.arrival_s - line_s_;
  watch_queue(now, late_s);
  return from_seconds(late_s);
}

void FrameClock::learn(const Mark& now) {
  ++block_frames_;
  const double passed_s = now.arrival_s - block_.arrival_s;
  const bool is_late = now.arrival_s - line_s_ > kLate_s;
  if (is_late || passed_s < kBlock_s || block_frames_ < kBlockFrames || now.tick == block_.tick) {
    return;
  }
  const double pace_s = passed_s / static_cast<double>(now.tick - block_.tick);
  const bool is_even = std::abs(pace_s - block_tick_s_) < kSamePace * pace_s;
  if (tick_s_ > 0.0 && std::abs(pace_s - tick_s_) < kRefinesPace * tick_s_) {
    tick_s_ += kRefineGain * (pace_s - tick_s_);
  } else if (is_even && (tick_s_ <= 0.0 || pace_s < tick_s_)) {
    tick_s_ = 0.5 * (pace_s + block_tick_s_);
  }
  block_tick_s_ = pace_s;
  block_ = now;
  block_frames_ = 0;
}

void FrameClock::watch_queue(const Mark& now, double late_s) {
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

void FrameClock::on_echo(Duration round_trip) {
  if (!last_) {
    return;
  }
  const double round_trip_s = to_seconds(round_trip);
  least_round_trip_s_ = echoes_ == 0 ? round_trip_s : std::min(least_round_trip_s_, round_trip_s);
  round_trips_s_[echoes_++ % kEchoes] = round_trip_s;
  const bool is_short = round_trip_s < kUsualRoundTrip_s;
  if (last_->arrival_s - line_s_ > round_trip_s + kEchoSlack_s) {
    line_s_ = last_->arrival_s - round_trip_s;
    ++refutations_;
    if (is_short && refutations_ >= static_cast<int>(kEchoes) && echo_mark_ &&
        last_->tick > echo_mark_->tick) {
      is_refuted_ = true;
      tick_s_ = (last_->arrival_s - echo_mark_->arrival_s) /
                static_cast<double>(last_->tick - echo_mark_->tick);
    }
  } else {
    refutations_ = 0;
  }
  echo_mark_ = is_short ? last_ : std::nullopt;
  if (echoes_ >= kEchoes) {
    const double waited_s = *std::min_element(round_trips_s_.begin(), round_trips_s_.end()) -
                            std::min(least_round_trip_s_, kUsualRoundTrip_s);
    line_s_ = std::min(line_s_, last_->arrival_s - waited_s);
  }
}

}  // namespace vantage::drivers::vicon
