#pragma once

#include <Eigen/Core>

namespace vantage::test {

/// Returns the Jacobian by central differences: column j is (f(x + h·e_j) − f(x − h·e_j)) / 2h.
/// Error O(h²). Every analytic Jacobian in models/ is checked against it.
template <int M, int N, class F>
Eigen::Matrix<double, M, N> numerical_jacobian(const F& f, const Eigen::Matrix<double, N, 1>& x,
                                               double h = 1e-6) {
  Eigen::Matrix<double, M, N> J;
  for (int j = 0; j < N; ++j) {
    Eigen::Matrix<double, N, 1> step = Eigen::Matrix<double, N, 1>::Zero();
    step(j) = h;
    J.col(j) = (f(x + step) - f(x - step)) / (2.0 * h);
  }
  return J;
}

}  // namespace vantage::test
