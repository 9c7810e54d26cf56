#pragma once

#include <random>

#include <Eigen/Core>

#include "core/pose.hpp"

namespace vantage::test {

/// Random values for property tests; the same seed gives the same values.
class Random {
 public:
  explicit Random(std::uint64_t seed) : rng_(seed) {}

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(rng_);
  }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(rng_); }
  bool coin() { return integer(0, 1) == 1; }
  double normal() { return std::normal_distribution<double>()(rng_); }

  template <int N>
  Eigen::Matrix<double, N, 1> vector(double low, double high) {
    return Eigen::Matrix<double, N, 1>::NullaryExpr([&] { return uniform(low, high); });
  }
  Pose2 pose2(double half_side_m) {
    return {uniform(-half_side_m, half_side_m), uniform(-half_side_m, half_side_m),
            uniform(-kPi, kPi)};
  }
  Pose3 pose3(double half_side_m) {
    Pose3 pose;
    pose.translation_m = vector<3>(-half_side_m, half_side_m);
    pose.rotation.coeffs() = vector<4>(-1.0, 1.0).normalized();
    return pose;
  }
  /// Returns A Aᵀ + floor I with entries of A in [-1, 1]: symmetric, positive definite.
  Eigen::MatrixXd spd(int n, double floor) {
    const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return uniform(-1, 1); });
    return A * A.transpose() + floor * Eigen::MatrixXd::Identity(n, n);
  }
  std::mt19937_64& engine() { return rng_; }

 private:
  std::mt19937_64 rng_;
};

}  // namespace vantage::test
