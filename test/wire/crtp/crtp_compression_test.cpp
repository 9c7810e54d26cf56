#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "wire/crtp/compression.hpp"

namespace vantage::wire::crtp {
namespace {

TEST(CrtpCompression, MatchesTheBytesOfAnotherClient) {
  const double half = std::sqrt(0.5);
  EXPECT_EQ(compress(Quaternion(0.9, 0.1, -0.2, 0.3)), 0xc4aa50deU);
  EXPECT_EQ(compress(Quaternion(1.0, 0.0, 0.0, 0.0)), 0xc0000000U);
  EXPECT_EQ(compress(Quaternion(half, 0.0, 0.0, -half - 1e-12)), 0xa00803ffU);
  EXPECT_EQ(compress(Quaternion(0.3, -0.8, 0.1, 0.2)), 0x252a92f5U);
}

TEST(CrtpCompression, KeepsRotationsWithinAThirdOfADegree) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 20'000; ++i) {
    const Quaternion q =
        Quaternion(normal(random), normal(random), normal(random), normal(random)).normalized();
    ASSERT_LT(decompress(*compress(q)).angularDistance(q), 0.006);
  }
}

TEST(CrtpCompression, AnyInputGivesAUnitQuaternion) {
  std::mt19937 random(4);
  for (int i = 0; i < 20'000; ++i) {
    ASSERT_NEAR(decompress(static_cast<std::uint32_t>(random())).norm(), 1.0, 1e-12);
  }
}

TEST(CrtpCompression, RefusesZeroAndNonFiniteQuaternions) {
  EXPECT_FALSE(compress(Quaternion(0.0, 0.0, 0.0, 0.0)));
  EXPECT_FALSE(compress(Quaternion(std::nan(""), 0.0, 0.0, 0.0)));
}

TEST(CrtpCompression, AllHalfPrecisionNumbersRoundTrip) {
  for (std::uint32_t bits = 0; bits <= 0xFFFFU; ++bits) {
    const float value = from_half(static_cast<std::uint16_t>(bits));
    if (!std::isnan(value)) {
      ASSERT_EQ(to_half(value), bits);
    } else {
      ASSERT_TRUE(std::isnan(from_half(to_half(value))));
    }
  }
}

TEST(CrtpCompression, RoundsToTheNearestHalfPrecisionNumber) {
  EXPECT_EQ(from_half(0x3C00), 1.0F);
  EXPECT_EQ(from_half(0x0001), std::ldexp(1.0F, -24));
  EXPECT_EQ(from_half(0x7BFF), 65504.0F);
  EXPECT_EQ(to_half(65519.0F), 0x7BFF);
  EXPECT_EQ(to_half(65520.0F), 0x7C00);
  EXPECT_EQ(to_half(-std::numeric_limits<float>::infinity()), 0xFC00);
  EXPECT_EQ(to_half(1.0F + std::ldexp(1.0F, -11)), 0x3C00) << "tie to even";
  EXPECT_EQ(to_half(1.0F + 3.0F * std::ldexp(1.0F, -11)), 0x3C02) << "tie to even";
  EXPECT_EQ(to_half(std::ldexp(1.0F, -26)), 0);
}

}  // namespace
}  // namespace vantage::wire::crtp
