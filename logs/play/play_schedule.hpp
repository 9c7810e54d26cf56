#pragma once

#include <cstdint>

#include "core/time.hpp"

namespace vantage::logs {

/// Schedule that maps each instant of a log to its due time on a monotonic clock (CLOCK_MONOTONIC,
/// ns), across pauses, seeks and changes of speed. Due times are counted from the last pause, seek
/// or change of speed, so timing errors do not accumulate. Positions and times are ≥ 0, as in a
/// log. It reads no clock: callers pass the time.
class PlaySchedule {
 public:
  /// Starts paused at `position`. Precondition: speed > 0.
  PlaySchedule(Time position, double speed) : position_(position), speed_(speed) {}

  void resume(std::int64_t now_ns);
  void pause(std::int64_t now_ns);
  void seek(Time position, std::int64_t now_ns);
  /// Precondition: speed > 0.
  void set_speed(double speed, std::int64_t now_ns);

  [[nodiscard]] bool is_paused() const { return is_paused_; }
  [[nodiscard]] double speed() const { return speed_; }
  /// Returns the position in the log.
  [[nodiscard]] Time position(std::int64_t now_ns) const;
  /// Returns the clock time, ns, at which `time` is due. Precondition: not paused.
  [[nodiscard]] std::int64_t due_ns(Time time) const;

 private:
  Time position_;
  double speed_;
  bool is_paused_ = true;
  std::int64_t since_ns_ = 0;  ///< ns; clock time at which position_ was valid
};

}  // namespace vantage::logs
