#include "core/uniform.hpp"

#include <cstdint>

#include <gtest/gtest.h>

namespace vantage {
namespace {

// The C++ standard defines the engine's 10 000th number for every library.
TEST(Uniform, UsesTheUpperBitsOfOneDraw) {
  std::mt19937_64 random;
  random.discard(9'999);
  EXPECT_EQ(uniform(random, 0.0, 0x1p53), static_cast<double>(9'981'545'732'273'789'042U >> 11U));
  std::mt19937_64 twin;
  twin.discard(10'000);
  EXPECT_EQ(random(), twin());
}

TEST(Uniform, CoversItsRange) {
  std::mt19937_64 random(3);
  const int draws = 100'000;
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < draws; ++i) {
    const double x = uniform(random, -2.0, 4.0);
    ASSERT_GE(x, -2.0);
    ASSERT_LT(x, 4.0);
    sum += x;
    squares += x * x;
  }
  // The draws have the mean (a + b) / 2 and the second moment (a² + ab + b²) / 3, within five
  // standard errors.
  EXPECT_NEAR(sum / draws, 1.0, 0.03);
  EXPECT_NEAR(squares / draws, 4.0, 0.08);
}

}  // namespace
}  // namespace vantage
