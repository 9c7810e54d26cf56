#pragma once

#include <cstdint>

#include "core/time.hpp"
#include "tools/view/protocol.hpp"

namespace vantage::tools {

/// Position of a log player. During playback, position = anchor + speed · (now − time of the last
/// control), clamped to the log's range. Pure: the caller passes the time of its monotonic clock.
class PlaybackClock {
 public:
  /// Starts paused at `start`. Precondition: start ≤ end.
  PlaybackClock(Time start, Time end) : start_(start), end_(end), anchor_(start) {}

  /// Changes the range of the log. Precondition: start ≤ end.
  void set_range(Time start, Time end) {
    start_ = start;
    end_ = end;
  }
  [[nodiscard]] Time position(std::int64_t now_ns) const;
  [[nodiscard]] PlaybackState state(std::int64_t now_ns) const;
  /// Obeys a request and returns the new state with the request's id. A request to play at the end
  /// of the log starts from its beginning. Speeds are clamped to [0.01, 100].
  PlaybackState control(const PlaybackControl& request, std::int64_t now_ns);

 private:
  Time start_;
  Time end_;
  Time anchor_;
  std::int64_t anchor_ns_ = 0;
  bool is_playing_ = false;
  float speed_ = 1.0F;
};

}  // namespace vantage::tools
