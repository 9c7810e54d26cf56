#pragma once

#include <random>

namespace vantage {

/// Returns one of 2⁵³ equally likely numbers in [low, high), from one call of `random`. Unlike
/// std::uniform_real_distribution, the result is the same with every standard library.
inline double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
}

}  // namespace vantage
