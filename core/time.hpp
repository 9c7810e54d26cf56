#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

namespace vantage {

/// Clock of the stack: microseconds since the Unix epoch, as in the `utime` field of every LCM
/// message. The clock has no now(): library code receives a Time as argument, so that it computes
/// the same results for a replayed log as on a live robot.
struct StackClock {
  using rep = std::int64_t;
  using period = std::micro;
  using duration = std::chrono::duration<rep, period>;
  using time_point = std::chrono::time_point<StackClock>;
  static constexpr bool is_steady = false;  // NOLINT(readability-identifier-naming): std Clock
};

using Duration = StackClock::duration;
using Time = StackClock::time_point;

/// Returns `d` in seconds.
constexpr double to_seconds(Duration d) { return std::chrono::duration<double>(d).count(); }

/// Returns `seconds_s` rounded to whole microseconds.
inline Duration from_seconds(double seconds_s) {
  return Duration{static_cast<std::int64_t>(std::llround(seconds_s * 1e6))};
}

constexpr Time from_utime(std::int64_t utime_us) { return Time{Duration{utime_us}}; }
constexpr std::int64_t to_utime(Time t) { return t.time_since_epoch().count(); }

}  // namespace vantage
