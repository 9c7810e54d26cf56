#include "core/result.hpp"

#include <memory>

#include <gtest/gtest.h>

namespace vantage {
namespace {

Result<int> halved(int number) {
  if (number % 2 != 0) {
    return Error{std::to_string(number) + " is odd"};
  }
  return number / 2;
}

TEST(Result, HoldsTheValueOfASuccess) {
  const Result<int> result = halved(42);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result.value(), 21);
  EXPECT_THROW((void)result.error(), std::bad_variant_access);
}

TEST(Result, HoldsTheReasonOfAFailure) {
  const Result<int> result = halved(7);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().message, "7 is odd");
  EXPECT_THROW((void)result.value(), std::bad_variant_access);
}

TEST(Result, DistinguishesErrorAndValueOfEqualText) {
  EXPECT_TRUE(Result<std::string>(std::string("x")).ok());
  EXPECT_FALSE(Result<std::string>(Error{"x"}).ok());
}

TEST(Result, ReturnsAMoveOnlyValue) {
  Result<std::unique_ptr<int>> result(std::make_unique<int>(5));
  const std::unique_ptr<int> owned = std::move(result).value();
  EXPECT_EQ(*owned, 5);
}

}  // namespace
}  // namespace vantage
