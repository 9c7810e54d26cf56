#include "core/check.hpp"

#include <gtest/gtest.h>

namespace vantage {
namespace {

TEST(Require, DoesNothingWhenTheRuleHolds) { EXPECT_NO_THROW(require(true, "1 < 2")); }

TEST(Require, ThrowsTheBrokenRule) {
  try {
    require(false, "resolution must be > 0 m");
    FAIL() << "did not throw";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "resolution must be > 0 m");
  }
}

}  // namespace
}  // namespace vantage
