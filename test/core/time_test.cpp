#include "core/time.hpp"

#include <gtest/gtest.h>

namespace vantage {
namespace {

TEST(Time, ConvertsToAndFromUtime) {
  for (const std::int64_t utime_us : {0L, 1L, 1'700'000'000'123'456L, -5L}) {
    EXPECT_EQ(to_utime(from_utime(utime_us)), utime_us);
  }
  EXPECT_EQ(from_utime(2'500'000) - from_utime(1'000'000), Duration{1'500'000});
}

TEST(FromSeconds, RoundsToTheNearestMicrosecond) {
  EXPECT_EQ(from_seconds(0.5), Duration{500'000});
  EXPECT_EQ(from_seconds(0.3), Duration{300'000});
  EXPECT_EQ(from_seconds(1.4e-6), Duration{1});
  EXPECT_EQ(from_seconds(1.6e-6), Duration{2});
  EXPECT_EQ(from_seconds(-1.6e-6), Duration{-2});
}

TEST(ToSeconds, InvertsFromSeconds) {
  for (std::int64_t us = -2'000'000; us <= 2'000'000; us += 77'777) {
    EXPECT_EQ(from_seconds(to_seconds(Duration{us})), Duration{us});
  }
}

}  // namespace
}  // namespace vantage
