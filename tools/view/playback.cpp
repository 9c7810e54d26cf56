#include "tools/view/playback.hpp"

#include <algorithm>

namespace vantage::tools {

Time PlaybackClock::position(std::int64_t now_ns) const {
  if (!is_playing_) {
    return anchor_;
  }
  const double elapsed_s = static_cast<double>(now_ns - anchor_ns_) * 1e-9;
  const Duration ahead = from_seconds(elapsed_s * static_cast<double>(speed_));
  return std::clamp(anchor_ + ahead, start_, end_);
}

PlaybackState PlaybackClock::state(std::int64_t now_ns) const {
  PlaybackState state;
  state.time = position(now_ns);
  state.speed = speed_;
  state.status = !is_playing_         ? PlaybackStatus::kPaused
                 : state.time == end_ ? PlaybackStatus::kEnded
                                      : PlaybackStatus::kPlaying;
  return state;
}

PlaybackState PlaybackClock::control(const PlaybackControl& request, std::int64_t now_ns) {
  anchor_ = position(now_ns);
  anchor_ns_ = now_ns;
  bool did_seek = request.seek.has_value();
  if (request.seek) {
    anchor_ = std::clamp(*request.seek, start_, end_);
  } else if (request.play && anchor_ == end_) {
    anchor_ = start_;
    did_seek = true;
  }
  is_playing_ = request.play;
  speed_ = std::clamp(request.speed, 0.01F, 100.0F);
  PlaybackState after = state(now_ns);
  after.did_seek = did_seek;
  after.request_id = request.request_id;
  return after;
}

}  // namespace vantage::tools
