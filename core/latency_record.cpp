#include "core/latency_record.hpp"

#include <algorithm>
#include <cmath>

namespace vantage {

void LatencyRecord::add(Duration latency) {
  const std::int64_t us = std::max<std::int64_t>(0, latency.count());
  ++bins_[std::min(kBins - 1, static_cast<std::size_t>(us / kStepUs))];
  ++count_;
  max_us_ = std::max(max_us_, us);
}

std::int64_t LatencyRecord::percentile_us(double share) const {
  const auto wanted = static_cast<std::int64_t>(std::ceil(share * static_cast<double>(count_)));
  std::int64_t seen = 0;
  for (std::size_t i = 0; i < kBins && count_ > 0; ++i) {
    seen += bins_[i];
    if (seen >= wanted) {
      return i + 1 == kBins ? max_us_
                            : std::min(max_us_, static_cast<std::int64_t>(i + 1) * kStepUs);
    }
  }
  return max_us_;
}

}  // namespace vantage
