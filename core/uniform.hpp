#pragma once

#include <random>

namespace vantage {

/// A number in [low, high) of 2⁵³ that are equally likely, of one draw: the same with every
/// standard library, which those of std::uniform_real_distribution need not be.
inline double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
}

}  // namespace vantage
