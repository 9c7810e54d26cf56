#pragma once

#include <cstdint>

#include "core/time.hpp"
#include "tools/view/protocol.hpp"

namespace vantage::tools {

/// Where a log player is: position = anchor + speed · (now − then) while it plays, held at the
/// ends. Pure: now comes from the caller's monotonic clock.
class PlaybackClock {
 public:
  /// Paused at the start. Precondition: start ≤ end.
  PlaybackClock(Time start, Time end) : start_(start), end_(end), anchor_(start) {}

  /// The log is longer or shorter than was known. Precondition: start ≤ end.
  void set_range(Time start, Time end) {
    start_ = start;
    end_ = end;
  }
  [[nodiscard]] Time position(std::int64_t now_ns) const;
  [[nodiscard]] PlaybackState state(std::int64_t now_ns) const;
  /// Obeys; the state afterwards, with the request's id. Playing at the end begins anew. Speeds are
  /// held within [0.01, 100].
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
