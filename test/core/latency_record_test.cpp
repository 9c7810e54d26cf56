#include "core/latency_record.hpp"

#include <gtest/gtest.h>

namespace vantage {
namespace {

TEST(LatencyRecord, ReturnsPercentilesWithinOneBin) {
  LatencyRecord record;
  EXPECT_EQ(record.percentile_us(0.5), 0);
  for (int k = 1; k <= 1000; ++k) {
    record.add(Duration{10 * k});
  }
  EXPECT_NEAR(static_cast<double>(record.percentile_us(0.5)), 5000.0, LatencyRecord::kStepUs);
  EXPECT_NEAR(static_cast<double>(record.percentile_us(0.99)), 9900.0, LatencyRecord::kStepUs);
  EXPECT_EQ(record.max_us(), 10'000);
  record.add(std::chrono::seconds(7));
  EXPECT_EQ(record.max_us(), 7'000'000);
  EXPECT_EQ(record.percentile_us(1.0), 7'000'000);
}

}  // namespace
}  // namespace vantage
