#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

// Four doubles in the compiler's vector type. Every lane executes the same IEEE operations, so a
// result depends neither on its lane nor on other lanes. Without AVX the compiler uses two halves
// or four scalars.

namespace vantage::planner {

inline constexpr int kLanes = 4;

using Lanes = double __attribute__((vector_size(32)));
/// Mask in which all bits of a lane are 1 (true) or 0 (false).
using LaneMask = std::int64_t __attribute__((vector_size(32)));

inline Lanes broadcast(double value) { return Lanes{value, value, value, value}; }

/// Loads `values[0 … 3]`.
inline Lanes load(const double* values) {
  Lanes lanes;
  std::memcpy(&lanes, values, sizeof(lanes));
  return lanes;
}
inline void store(double* values, const Lanes& lanes) {
  std::memcpy(values, &lanes, sizeof(lanes));
}

/// Returns one bit per lane, lane 0 lowest.
inline unsigned bits(const LaneMask& mask) {
#ifdef __AVX__
  return static_cast<unsigned>(__builtin_ia32_movmskpd256(reinterpret_cast<Lanes>(mask)));
#else
  return static_cast<unsigned>((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
#endif
}

inline Lanes sqrt(const Lanes& x) {
#ifdef __AVX__
  return __builtin_ia32_sqrtpd256(x);
#else
  return Lanes{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
#endif
}

}  // namespace vantage::planner
