#pragma once

#include <cmath>

#include <Eigen/Core>

namespace vantage::sim {

/// Returns the exact response over `dt_s` of ẋ = (command − x) / time_constant to a constant
/// command, with the norm of the change limited to `rate_max` · dt_s:
/// x(t + dt) = command + (x − command) e^(−dt/T) while the change is within the limit.
template <int N>
Eigen::Matrix<double, N, 1> first_order_lag(const Eigen::Matrix<double, N, 1>& x,
                                            const Eigen::Matrix<double, N, 1>& command,
                                            double time_constant_s, double rate_max, double dt_s) {
  Eigen::Matrix<double, N, 1> change = (command - x) * -std::expm1(-dt_s / time_constant_s);
  const double norm = change.norm();
  if (norm > rate_max * dt_s) {
    change *= rate_max * dt_s / norm;
  }
  return x + change;
}

}  // namespace vantage::sim
