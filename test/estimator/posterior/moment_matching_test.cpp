#include "estimator/posterior/moment_matching.hpp"

#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "test/support/near.hpp"
#include "test/support/random.hpp"

namespace vantage::estimator {
namespace {

using models::Gaussian;
using vantage::test::is_near;

TEST(ProductRule, HasTheMomentsOfTheNormalDistribution) {
  EXPECT_EQ(ProductRule::of(2).size, 15);
  EXPECT_EQ(ProductRule::of(3).size, 7);
  for (const Eigen::Index dim : {2, 3}) {
    const ProductRule& rule = ProductRule::of(dim);
    double moment[4] = {0.0, 0.0, 0.0, 0.0};
    for (int i = 0; i < rule.size; ++i) {
      const auto at = static_cast<std::size_t>(i);
      for (int power = 0; power < 4; ++power) {
        moment[power] += rule.weight[at] * std::pow(rule.point[at], power);
      }
      EXPECT_NEAR(rule.point[at], rule.point[0] + i * rule.spacing, 1e-12);
      // The weights are those of a normal distribution at points from −3 to 3, before these points
      // are spread slightly.
      const double put_apart = 3.0 / std::abs(rule.point[0]);
      EXPECT_NEAR(rule.weight[at] / rule.weight[0],
                  std::exp(0.5 * (9.0 - std::pow(put_apart * rule.point[at], 2))), 1e-9);
    }
    EXPECT_NEAR(moment[0], 1.0, 1e-12);
    EXPECT_NEAR(moment[1], 0.0, 1e-12);
    EXPECT_NEAR(moment[2], 1.0, 1e-12);
    EXPECT_NEAR(moment[3], 0.0, 1e-12);
    EXPECT_NEAR(rule.point[0], -3.0, 0.1);
    EXPECT_GT(rule.spacing, 0.0);
  }
}

// exp(−½ (y − m)ᵀ W (y − m)) is a position measurement. Posterior, velocity and likelihood must
// equal those of a Kalman filter.
TEST(Reweighted, EqualsAKalmanUpdateForAGaussianLikelihood) {
  vantage::test::Random random(11);
  for (int trial = 0; trial < 60; ++trial) {
    const int dim = 2 + trial % 3;
    const int n = dim == 3 ? 3 : 2;
    const Eigen::VectorXd mean = random.vector<4>(-3.0, 3.0).head(dim);
    const Eigen::MatrixXd P = random.spd(dim, 0.3);
    const Eigen::MatrixXd P_pp = P.topLeftCorner(n, n);
    // The measurement has about half of the prior's information and is about one σ away.
    const Eigen::MatrixXd W_inverse = 2.0 * P_pp + 0.3 * random.spd(n, 0.1);
    const Eigen::MatrixXd W = W_inverse.inverse();
    const Eigen::VectorXd off =
        Eigen::MatrixXd(P_pp.llt().matrixL()) * random.vector<3>(-0.6, 0.6).head(n);
    const Eigen::VectorXd m = mean.head(n) + off;
    double share = -1.0;
    const Gaussian made = reweighted(
        Gaussian{mean, P},
        [&](const models::PositionVector& y_m) {
          const Eigen::VectorXd d = Eigen::VectorXd(y_m) - m;
          return std::exp(-0.5 * d.dot(W * d));
        },
        &share);
    const Eigen::MatrixXd gain = P.leftCols(n) * (P_pp + W_inverse).inverse();
    const Eigen::VectorXd right = mean + gain * off;
    const Eigen::MatrixXd covariance = P - gain * P.topRows(n);
    const Eigen::LLT<Eigen::MatrixXd> root(covariance);
    EXPECT_LT(root.matrixL().solve(Eigen::VectorXd(made.mean) - right).norm(), 0.02) << dim;
    EXPECT_LT((Eigen::MatrixXd(made.covariance) - covariance).norm(), 0.03 * covariance.norm())
        << dim;
    EXPECT_EQ(made.covariance, made.covariance.transpose());
    const Eigen::MatrixXd after_pp = (P_pp.inverse() + W).inverse();
    EXPECT_NEAR(share,
                std::sqrt(after_pp.determinant() / P_pp.determinant()) *
                    std::exp(-0.5 * off.dot((P_pp + W_inverse).inverse() * off)),
                0.01)
        << dim;
  }
}

// If the likelihood allows only one point of the rule, the result has its mean at that point and
// the width of one cell.
TEST(Reweighted, IsAtLeastOneCellWide) {
  Eigen::Matrix4d root = Eigen::Matrix4d::Zero();
  root << 2.0, 0.0, 0.0, 0.0, 0.5, 1.5, 0.0, 0.0, 0.3, -0.2, 1.0, 0.0, 0.1, 0.4, 0.2, 0.7;
  for (const int dim : {2, 3, 4}) {
    const int n = dim == 3 ? 3 : 2;
    const Eigen::MatrixXd L = root.topLeftCorner(dim, dim);
    const Gaussian belief{Eigen::VectorXd::LinSpaced(dim, 1.0, 2.0), L * L.transpose()};
    const ProductRule& rule = ProductRule::of(n);
    Eigen::VectorXd u = Eigen::VectorXd::Zero(n);
    u(0) = rule.point[2];
    u(1) = rule.point[4];
    const Eigen::VectorXd there = Eigen::VectorXd(belief.mean.head(n)) + L.topLeftCorner(n, n) * u;
    double share = 0.0;
    const Gaussian made = reweighted(
        belief,
        [&](const models::PositionVector& y_m) {
          return (Eigen::VectorXd(y_m) - there).norm() < 1e-6 ? 1.0 : 0.0;
        },
        &share);
    const double middle = rule.weight[static_cast<std::size_t>(rule.size / 2)];
    EXPECT_NEAR(share, rule.weight[2] * rule.weight[4] * (n == 3 ? middle : 1.0), 1e-12);
    EXPECT_TRUE(is_near(made.mean.head(n), there, 1e-9));
    const double cell = rule.spacing * rule.spacing / 12.0;
    const Eigen::MatrixXd L_pp = L.topLeftCorner(n, n);
    EXPECT_TRUE(is_near(made.covariance.topLeftCorner(n, n), cell * L_pp * L_pp.transpose(), 1e-9));
    if (dim == 4) {  // uncertainty of the velocity given the position
      const Eigen::MatrixXd L_vp = L.bottomLeftCorner(2, 2);
      const Eigen::MatrixXd L_vv = L.bottomRightCorner(2, 2);
      EXPECT_TRUE(is_near(made.covariance.bottomRightCorner(2, 2),
                          cell * L_vp * L_vp.transpose() + L_vv * L_vv.transpose(), 1e-9));
      EXPECT_TRUE(is_near(made.mean.tail(2), belief.mean.tail(2) + L_vp * u, 1e-9));
    }
  }
}

TEST(Reweighted, KeepsABeliefWithoutUsableWeights) {
  const Gaussian belief{Eigen::Vector2d(1.0, 2.0), Eigen::Matrix2d::Identity()};
  double share = -1.0;
  Gaussian same = reweighted(
      belief, [](const auto&) { return 1.0; }, &share);
  EXPECT_EQ(same.mean, belief.mean);
  EXPECT_EQ(same.covariance, belief.covariance);
  EXPECT_EQ(share, 1.0);
  // The likelihood contradicts the prior. Its remaining share is slightly below or above 10⁻⁶.
  for (const double left : {0.99e-6, 1.01e-6}) {
    const auto likelihood = [&](const models::PositionVector& y_m) {
      return y_m(0) > 1.0 ? 2.0 * left : 1e-9;  // excludes the middle column
    };
    const ProductRule& rule = ProductRule::of(2);
    const double half = 0.5 * (1.0 - rule.weight[7]);
    const Gaussian after = reweighted(
        belief, [&](const auto& y_m) { return likelihood(y_m) / (2.0 * half); }, &share);
    EXPECT_NEAR(share, left, 1e-8);
    EXPECT_EQ(after.mean == belief.mean, left < 1e-6);
  }
  Gaussian none = belief;
  none.covariance(1, 1) = -1.0;
  EXPECT_EQ(reweighted(none, [](const auto&) { return 0.5; }).covariance, none.covariance);
}

}  // namespace
}  // namespace vantage::estimator
