#include "core/angle.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "test/support/random.hpp"

namespace vantage {
namespace {

TEST(WrapToPi, ReturnsAnglesInTheHalfOpenInterval) {
  test::Random random(1);
  for (int i = 0; i < 100'000; ++i) {
    const double angle_rad = random.uniform(-1e3, 1e3);
    const double wrapped_rad = wrap_to_pi(angle_rad);
    ASSERT_GT(wrapped_rad, -kPi);
    ASSERT_LE(wrapped_rad, kPi);
    ASSERT_NEAR(std::cos(wrapped_rad), std::cos(angle_rad), 1e-12);
    ASSERT_NEAR(std::sin(wrapped_rad), std::sin(angle_rad), 1e-12);
  }
}

TEST(WrapToPi, KeepsWrappedAngles) {
  test::Random random(2);
  for (int i = 0; i < 10'000; ++i) {
    const double angle_rad = random.uniform(-kPi, kPi);
    ASSERT_EQ(wrap_to_pi(angle_rad), angle_rad);
  }
}

TEST(WrapToPi, MapsMinusPiToPlusPi) {
  EXPECT_EQ(wrap_to_pi(kPi), kPi);
  EXPECT_EQ(wrap_to_pi(-kPi), kPi);
  EXPECT_EQ(wrap_to_pi(3.0 * kPi), kPi);
  EXPECT_EQ(wrap_to_pi(-3.0 * kPi), kPi);
  EXPECT_EQ(wrap_to_pi(2.0 * kPi), 0.0);
  EXPECT_LT(wrap_to_pi(std::nextafter(kPi, 4.0)), 0.0);
}

TEST(WrapToPi, ReturnsNanForNanAndInfinity) {
  EXPECT_TRUE(std::isnan(wrap_to_pi(std::nan(""))));
  EXPECT_TRUE(std::isnan(wrap_to_pi(INFINITY)));
}

TEST(Degrees, AreTheInverseOfRadians) {
  static_assert(radians(180.0) == kPi);
  for (double angle_deg = -720.0; angle_deg <= 720.0; angle_deg += 7.5) {
    EXPECT_NEAR(degrees(radians(angle_deg)), angle_deg, 1e-12);
  }
}

}  // namespace
}  // namespace vantage
