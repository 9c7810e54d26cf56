#include "tools/console/operator_claim.hpp"

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

constexpr Time kStart = from_utime(1'000'000);

TEST(OperatorClaim, HasOneHolderUntilItIsSilent) {
  OperatorClaim claim;
  EXPECT_FALSE(claim.is_held(kStart));
  EXPECT_TRUE(claim.claim("first", kStart));
  EXPECT_FALSE(claim.claim("second", kStart + OperatorClaim::kPresence));
  EXPECT_TRUE(claim.touch("first", kStart + OperatorClaim::kPresence));
  EXPECT_FALSE(claim.touch("second", kStart + OperatorClaim::kPresence));
  const Time silent = kStart + 2 * OperatorClaim::kPresence + Duration{1};
  EXPECT_FALSE(claim.is_held(silent));
  EXPECT_FALSE(claim.touch("first", silent)) << "a late page must claim again";
  EXPECT_TRUE(claim.claim("second", silent));
  EXPECT_FALSE(claim.is_holder("first", silent));
}

TEST(OperatorClaim, EndsWhenItsHolderLeaves) {
  OperatorClaim claim;
  EXPECT_TRUE(claim.claim("first", kStart));
  claim.release("second");
  EXPECT_TRUE(claim.is_held(kStart));
  claim.release("first");
  EXPECT_FALSE(claim.is_held(kStart));
}

TEST(IsSameSecret, ComparesAllBytesAndRefusesEmptySecrets) {
  EXPECT_TRUE(is_same_secret("abc", "abc"));
  for (const char* other : {"", "ab", "abd", "abcd", "Abc"}) {
    EXPECT_FALSE(is_same_secret(other, "abc")) << other;
    EXPECT_FALSE(is_same_secret("abc", other)) << other;
  }
  EXPECT_FALSE(is_same_secret("", "")) << "an empty key is refused";
}

}  // namespace
}  // namespace vantage::tools
