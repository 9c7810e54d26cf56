#pragma once

#include <cmath>
#include <numbers>

namespace vantage {

inline constexpr double kPi = std::numbers::pi;

/// Returns `angle_rad` plus the multiple of 2π that brings it into (−π, π].
inline double wrap_to_pi(double angle_rad) {
  if (angle_rad > -kPi && angle_rad < kPi) {
    // the angle is already in range; returning it is faster than remainder() and gives the same
    // result
    return angle_rad;
  }
  const double wrapped = std::remainder(angle_rad, 2.0 * kPi);
  return wrapped <= -kPi ? wrapped + 2.0 * kPi : wrapped;
}

constexpr double radians(double degrees) { return degrees * kPi / 180.0; }
constexpr double degrees(double radians) { return radians * 180.0 / kPi; }

}  // namespace vantage
