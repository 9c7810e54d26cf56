#pragma once

#include <Eigen/Core>
#include <gtest/gtest.h>

namespace vantage::test {

/// EXPECT_TRUE(is_near(actual, expected, tol)): true if max |difference| ≤ tol; prints both
/// otherwise.
template <class A, class B>
::testing::AssertionResult is_near(const Eigen::MatrixBase<A>& actual,
                                   const Eigen::MatrixBase<B>& expected, double tolerance) {
  if (actual.rows() != expected.rows() || actual.cols() != expected.cols()) {
    return ::testing::AssertionFailure()
           << "shape " << actual.rows() << "x" << actual.cols() << ", expected " << expected.rows()
           << "x" << expected.cols();
  }
  const double worst = (actual - expected).cwiseAbs().maxCoeff();
  // allFinite() is required since maxCoeff may ignore a NaN; infinities must not pass either.
  if ((actual - expected).allFinite() && worst <= tolerance) {
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure()
         << "worst difference " << worst << " > " << tolerance << "\nactual\n"
         << actual << "\nexpected\n"
         << expected;
}

}  // namespace vantage::test
