#pragma once

#include <array>
#include <cstdint>

#include "core/time.hpp"

namespace vantage {

/// How long something took, over and over: percentiles from a histogram of fixed size. Adding
/// allocates nothing.
class LatencyRecord {
 public:
  static constexpr std::int64_t kStepUs = 10;  ///< width of a bin, so also the percentiles' error
  static constexpr std::size_t kBins = 10'000;

  /// Negative ones count as none at all; ones beyond the last bin keep their length as the maximum.
  void add(Duration latency);
  [[nodiscard]] std::int64_t count() const { return count_; }
  /// The upper edge of the bin in which the `share`-th part of all ends; 0 before the first.
  [[nodiscard]] std::int64_t percentile_us(double share) const;
  [[nodiscard]] std::int64_t max_us() const { return max_us_; }

 private:
  std::array<std::int64_t, kBins> bins_{};
  std::int64_t count_ = 0;
  std::int64_t max_us_ = 0;
};

}  // namespace vantage
