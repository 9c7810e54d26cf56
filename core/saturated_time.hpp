#pragma once

#include <chrono>
#include <cstdint>
#include <limits>

#include "core/time.hpp"

// Arithmetic on times that others wrote, such as those in a log: any 64-bit number may occur.

namespace vantage {

/// Returns `t + d`, or the nearest time that there is when the sum does not fit.
constexpr Time saturated_sum(Time t, Duration d) {
  if (d >= Duration::zero()) {
    return t > Time::max() - d ? Time::max() : t + d;
  }
  return t < Time::min() - d ? Time::min() : t + d;
}

/// Returns the nearest whole number of microseconds to `seconds_s`, or the nearest Duration that
/// there is. Precondition: not NaN.
inline Duration saturated_seconds(double seconds_s) {
  constexpr double kMost_s = 9.2e12;
  return seconds_s > kMost_s    ? Duration::max()
         : seconds_s < -kMost_s ? -Duration::max()
                                : from_seconds(seconds_s);
}

/// Latest time that a clock is set to by a number from elsewhere: sums of it and of durations of up
/// to a century fit.
inline constexpr Time kClockTimeMax = Time::max() - std::chrono::hours(24 * 36'525);

/// Greatest number of nanoseconds that readers with signed numbers understand (year 2262).
inline constexpr std::int64_t kNanosecondsMax = std::numeric_limits<std::int64_t>::max();

/// True if nanoseconds_of(t) is exactly `t`.
constexpr bool fits_nanoseconds(Time t) {
  return to_utime(t) >= 0 && to_utime(t) <= kNanosecondsMax / 1000;
}

/// Returns the nanoseconds from the Unix epoch to `t`, held within [0, kNanosecondsMax].
constexpr std::uint64_t nanoseconds_of(Time t) {
  if (fits_nanoseconds(t)) {
    return static_cast<std::uint64_t>(to_utime(t)) * 1000U;
  }
  return to_utime(t) < 0 ? 0U : static_cast<std::uint64_t>(kNanosecondsMax);
}

}  // namespace vantage
