#pragma once

#include <cstdint>

#include "core/time.hpp"

namespace vantage::logs {

/// When each instant of a log is due on a clock that never jumps (CLOCK_MONOTONIC, ns), through
/// pauses, seeks and changes of speed. Each instant is counted from the last of these, so pacing
/// errors do not add up. Positions and times are not negative, as in a log. Pure: it is told what
/// time it is.
class PlaySchedule {
 public:
  /// Stands at `position`, paused. Precondition: speed > 0.
  PlaySchedule(Time position, double speed) : position_(position), speed_(speed) {}

  void resume(std::int64_t now_ns);
  void pause(std::int64_t now_ns);
  void seek(Time position, std::int64_t now_ns);
  /// Precondition: speed > 0.
  void set_speed(double speed, std::int64_t now_ns);

  [[nodiscard]] bool is_paused() const { return is_paused_; }
  [[nodiscard]] double speed() const { return speed_; }
  /// Where in the log it is.
  [[nodiscard]] Time position(std::int64_t now_ns) const;
  /// When `time` is due. Precondition: not paused.
  [[nodiscard]] std::int64_t due_ns(Time time) const;

 private:
  Time position_;
  double speed_;
  bool is_paused_ = true;
  std::int64_t since_ns_ = 0;  ///< when it stood at position_
};

}  // namespace vantage::logs
