#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include "models/belief/gaussian.hpp"

// Updates a Gaussian with a likelihood of the position that is not Gaussian: the product is
// replaced by the Gaussian with the same mean and covariance.

namespace vantage::estimator {

/// Equally spaced quadrature points with Gaussian weights, of mean 0 and variance 1 exactly.
struct ProductRule {
  static constexpr int kPointsMax = 15;
  static constexpr double kReachSigma = 3.0;

  int size = 0;
  double spacing = 0.0;
  std::array<double, kPointsMax> point{};
  std::array<double, kPointsMax> weight{};

  explicit ProductRule(int points) : size(points) {
    double total = 0.0;
    double variance = 0.0;
    for (int i = 0; i < size; ++i) {
      const auto k = static_cast<std::size_t>(i);
      point[k] = kReachSigma * (2.0 * i / (size - 1) - 1.0);
      weight[k] = std::exp(-0.5 * point[k] * point[k]);
      total += weight[k];
      variance += weight[k] * point[k] * point[k];
    }
    const double scale = 1.0 / std::sqrt(variance / total);
    for (int i = 0; i < size; ++i) {
      weight[static_cast<std::size_t>(i)] /= total;
      point[static_cast<std::size_t>(i)] *= scale;
    }
    spacing = point[1] - point[0];
  }

  /// Returns the rule for `position_dim`: 15 points per coordinate in the plane, 7 in space.
  static const ProductRule& of(Eigen::Index position_dim) {
    static const ProductRule planar(15);
    static const ProductRule spatial(7);
    return position_dim == 3 ? spatial : planar;
  }
  /// Returns an upper bound of the distance of the rule's points from the mean of N(·, L Lᵀ), m.
  [[nodiscard]] double reach_m(const models::PositionMatrix& L) const {
    return std::abs(point[0]) * L.cwiseAbs().rowwise().sum().norm();
  }
};

/// Returns the Gaussian with the mean and covariance of N(y; μ, P) · likelihood(y) / Z, where y is
/// the position and 0 ≤ likelihood ≤ 1. The velocity follows through its correlation with the
/// position.
///
/// The moments come from a fixed product rule on ±3σ of the position ellipse. The rule is scaled to
/// have the first two moments of the Gaussian, so a constant likelihood changes nothing. The
/// covariance may shrink if one side is excluded, and may grow if the middle is excluded. In every
/// direction it is at least the variance of one cell of the rule, so it stays positive definite.
///
/// The belief is returned unchanged in three cases: the likelihood is 1 at every point, the
/// likelihood contradicts the belief (Z < 1e−6), or the covariance is not positive definite.
/// Cost: 225 (plane) or 343 (space) calls of `likelihood`, no allocation.
/// @param share  if not null: receives Z, or 1 if the likelihood is 1 at every point; not written
/// when the covariance is not positive definite
/// Source: assumed-density filtering; Ristic, Arulampalam, Gordon, Beyond the Kalman Filter (2004).
// Long function: it computes the points of a quadrature and their moments, and handles the cases in
// which the belief does not change.
template <class Likelihood>
models::Gaussian reweighted(const models::Gaussian& belief, const Likelihood& likelihood,
                            double* share = nullptr) {
  constexpr double kContradiction = 1e-6;
  const Eigen::Index n = belief.mean.size() == 3 ? 3 : 2;
  const Eigen::LLT<models::PositionMatrix> root(belief.covariance.topLeftCorner(n, n));
  if (root.info() != Eigen::Success) {
    return belief;
  }
  const models::PositionMatrix L = root.matrixL();
  const models::PositionVector mean_m = belief.mean.head(n);
  const ProductRule& rule = ProductRule::of(n);

  // Moments of the whitened position u, y = μ + L u.
  double Z = 0.0;
  bool is_plain = true;
  models::PositionVector sum = models::PositionVector::Zero(n);
  models::PositionMatrix sum_of_squares = models::PositionMatrix::Zero(n, n);
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  models::PositionVector u = models::PositionVector::Zero(n);
  const int last_axis = n == 3 ? rule.size : 1;
  for (int i = 0; i < rule.size; ++i) {
    for (int j = 0; j < rule.size; ++j) {
      for (int k = 0; k < last_axis; ++k) {
        u(0) = rule.point[at(i)];
        u(1) = rule.point[at(j)];
        double weight = rule.weight[at(i)] * rule.weight[at(j)];
        if (n == 3) {
          u(2) = rule.point[at(k)];
          weight *= rule.weight[at(k)];
        }
        const models::PositionVector y_m = mean_m + L * u;
        const double likely = likelihood(y_m);
        is_plain = is_plain && likely == 1.0;
        weight *= likely;
        Z += weight;
        sum += weight * u;
        sum_of_squares += weight * u * u.transpose();
      }
    }
  }
  if (share != nullptr) {
    *share = is_plain ? 1.0 : Z;
  }
  if (is_plain || Z < kContradiction) {
    return belief;
  }

  const models::PositionVector shift = sum / Z;
  const models::PositionMatrix S = sum_of_squares / Z - shift * shift.transpose();
  const Eigen::SelfAdjointEigenSolver<models::PositionMatrix> axes(S);
  const double floor = rule.spacing * rule.spacing / 12.0;
  const models::PositionMatrix S_floored = axes.eigenvectors() *
                                           axes.eigenvalues().cwiseMax(floor).asDiagonal() *
                                           axes.eigenvectors().transpose();
  // y = μ + G u + (part uncorrelated with the position), G = P_{:p} L⁻ᵀ.
  using Gain = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                             models::kMaxTargetDim, 3>;
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3,
                      models::kMaxTargetDim>
      Gt = root.matrixL().solve(belief.covariance.topRows(n));
  const Gain G = Gt.transpose();
  models::Gaussian posterior = belief;
  posterior.mean += G * shift;
  const models::PositionMatrix change = S_floored - models::PositionMatrix::Identity(n, n);
  posterior.covariance += G * change * G.transpose();
  posterior.covariance = (0.5 * (posterior.covariance + posterior.covariance.transpose())).eval();
  return posterior;
}

}  // namespace vantage::estimator
