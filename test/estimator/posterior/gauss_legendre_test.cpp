#include "estimator/posterior/gauss_legendre.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace vantage::estimator {
namespace {

// The rule has 12 points. It is exact for every polynomial up to degree 23, and is the only such
// rule.
TEST(GaussLegendre, IsExactForPolynomialsUpToDegree23) {
  for (int degree = 0; degree <= 23; ++degree) {
    double sum = 0.0;
    for (std::size_t i = 0; i < kLegendrePoints; ++i) {
      sum += kLegendreWeight[i / 2] * std::pow(kLegendreSide[i % 2] * kLegendreNode[i / 2], degree);
    }
    EXPECT_NEAR(sum, degree % 2 == 0 ? 2.0 / (degree + 1) : 0.0, 1e-13) << degree;
  }
}

}  // namespace
}  // namespace vantage::estimator
