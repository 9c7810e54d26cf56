#pragma once

#include <array>
#include <cstdint>

#include "core/time.hpp"

namespace vantage {

/// Record of durations in a histogram of fixed size, for percentiles. Adding does not allocate.
class LatencyRecord {
 public:
  /// width of a bin, which is also the maximum error of percentiles
  static constexpr std::int64_t kStepUs = 10;
  static constexpr std::size_t kBins = 10'000;

  /// Adds a latency. Negative values count as 0; values beyond the last bin are counted in the last
  /// bin. The maximum is exact.
  void add(Duration latency);
  [[nodiscard]] std::int64_t count() const { return count_; }
  /// Returns the quantile `share` (0 to 1), rounded up to the edge of its bin; 0 if nothing was
  /// added.
  [[nodiscard]] std::int64_t percentile_us(double share) const;
  [[nodiscard]] std::int64_t max_us() const { return max_us_; }

 private:
  std::array<std::int64_t, kBins> bins_{};
  std::int64_t count_ = 0;
  std::int64_t max_us_ = 0;
};

}  // namespace vantage
