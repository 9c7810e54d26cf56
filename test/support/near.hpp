#pragma once

#include <Eigen/Core>
#include <gtest/gtest.h>

namespace vantage::test {

/// True if max |actual − expected| ≤ tol; otherwise prints both: EXPECT_TRUE(is_near(actual,
/// expected, tol)).
template <class A, class B>
::testing::AssertionResult is_near(const Eigen::MatrixBase<A>& actual,
                                   const Eigen::MatrixBase<B>& expected, double tolerance) {
  if (actual.rows() != expected.rows() || actual.cols() != expected.cols()) {
    return ::testing::AssertionFailure()
           << "shape " << actual.rows() << "x" << actual.cols() << ", expected " << expected.rows()
           << "x" << expected.cols();
  }
  const double worst = (actual - expected).cwiseAbs().maxCoeff();
  // allFinite() refuses infinities, and NaN, which maxCoeff() may ignore.
  if ((actual - expected).allFinite() && worst <= tolerance) {
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure()
         << "worst difference " << worst << " > " << tolerance << "\nactual\n"
         << actual << "\nexpected\n"
         << expected;
}

}  // namespace vantage::test
