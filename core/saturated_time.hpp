#pragma once

#include <chrono>
#include <cstdint>
#include <limits>

#include "core/time.hpp"

// Arithmetic on times from untrusted input, such as logs, which can contain any 64-bit number.

namespace vantage {

/// Returns `t + d`, or the nearest Time if the sum overflows.
constexpr Time saturated_sum(Time t, Duration d) {
  if (d >= Duration::zero()) {
    return t > Time::max() - d ? Time::max() : t + d;
  }
  return t < Time::min() - d ? Time::min() : t + d;
}

/// Returns `seconds_s` rounded to microseconds, or the nearest Duration if it overflows.
/// Precondition: not NaN.
inline Duration saturated_seconds(double seconds_s) {
  constexpr double kMost_s = 9.2e12;
  return seconds_s > kMost_s    ? Duration::max()
         : seconds_s < -kMost_s ? -Duration::max()
                                : from_seconds(seconds_s);
}

/// Latest time to which an external number may set a clock. Adding durations of up to a century to
/// it does not overflow.
inline constexpr Time kClockTimeMax = Time::max() - std::chrono::hours(24 * 36'525);

/// Largest number of nanoseconds since 1970 that fits a signed 64-bit number (year 2262).
inline constexpr std::int64_t kNanosecondsMax = std::numeric_limits<std::int64_t>::max();

/// True if nanoseconds_of(t) is exactly `t`.
constexpr bool fits_nanoseconds(Time t) {
  return to_utime(t) >= 0 && to_utime(t) <= kNanosecondsMax / 1000;
}

/// Returns the nanoseconds from the Unix epoch to `t`, limited to [0, kNanosecondsMax].
constexpr std::uint64_t nanoseconds_of(Time t) {
  if (fits_nanoseconds(t)) {
    return static_cast<std::uint64_t>(to_utime(t)) * 1000U;
  }
  return to_utime(t) < 0 ? 0U : static_cast<std::uint64_t>(kNanosecondsMax);
}

}  // namespace vantage
