#include "logs/metrics/team_estimate.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace vantage::logs {
namespace {

models::TargetBelief belief_with(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance) {
  models::TargetBelief out;
  out.information.matrix = covariance.inverse();
  out.information.vector = covariance.inverse() * mean;
  return out;
}

TEST(PositionEstimate, MarginalisesTheVelocity) {
  Eigen::Matrix4d root;
  root << 2.0, 0.3, 0.4, 0.1, 0.0, 1.0, 0.2, 0.5, 0.0, 0.0, 1.5, 0.3, 0.0, 0.0, 0.0, 0.7;
  const Eigen::Matrix4d covariance = root * root.transpose();
  const Eigen::Vector4d mean(1.0, -2.0, 0.3, 0.4);
  const auto estimate = position_estimate(belief_with(mean, covariance), "Q1", Time{}, 2);
  ASSERT_TRUE(estimate);
  EXPECT_NEAR(estimate->mean_m(0), 1.0, 1e-9);
  EXPECT_NEAR(estimate->mean_m(1), -2.0, 1e-9);
  const Eigen::Matrix2d block = covariance.topLeftCorner<2, 2>();
  const double two_pi_e = 2.0 * std::numbers::pi * std::numbers::e;
  EXPECT_NEAR(estimate->entropy_nats, 0.5 * std::log(two_pi_e * two_pi_e * block.determinant()),
              1e-9);
  EXPECT_NEAR(estimate->sigma_m(), std::sqrt(0.5 * block.trace()), 1e-9);
}

TEST(PositionEstimate, HasTheIsotropicEntropyForARoundGaussian) {
  const auto estimate = position_estimate(
      belief_with(Eigen::Vector2d::Zero(), 4.0 * Eigen::Matrix2d::Identity()), "Q1", Time{}, 2);
  ASSERT_TRUE(estimate);
  EXPECT_NEAR(estimate->entropy_nats, isotropic_entropy_nats(2.0, 2), 1e-12);
}

TEST(PositionEstimate, IsRefusedWithoutInformation) {
  models::TargetBelief ignorant;
  ignorant.information.matrix = Eigen::Matrix2d::Zero();
  ignorant.information.vector = Eigen::Vector2d::Zero();
  EXPECT_FALSE(position_estimate(ignorant, "Q1", Time{}, 2));
}

TEST(TeamEstimate, PrefersLeastEntropyThenNewestSightingThenName) {
  PositionEstimate vague{"Q1", Time{}, from_utime(9), {}, {}, 3.0};
  PositionEstimate old{"Q2", Time{}, from_utime(4), {}, {}, 1.0};
  PositionEstimate fresh{"Q4", Time{}, from_utime(5), {}, {}, 1.0};
  PositionEstimate fresh_too{"Q3", Time{}, from_utime(5), {}, {}, 1.0};
  TeamEstimate team;
  EXPECT_EQ(team.find(7), nullptr);
  team.offer(7, vague);
  EXPECT_EQ(team.find(7)->robot, "Q1");
  team.offer(7, old);
  EXPECT_EQ(team.find(7)->robot, "Q2");
  team.offer(7, fresh);
  EXPECT_EQ(team.find(7)->robot, "Q4");
  team.offer(7, fresh_too);
  EXPECT_EQ(team.find(7)->robot, "Q3");
  team.offer(7, vague);
  EXPECT_EQ(team.find(7)->robot, "Q3");
}

TEST(PositionEstimate, HasTheBeliefsDimension) {
  Eigen::Matrix3d root;
  root << 2.0, 0.3, 0.4, 0.0, 1.0, 0.2, 0.0, 0.0, 1.5;
  const Eigen::Matrix3d covariance = root * root.transpose();
  const Eigen::Vector3d mean(1.0, -2.0, 3.0);
  models::TargetBelief belief = belief_with(mean, covariance);
  belief.last_seen = from_utime(4);
  const auto estimate = position_estimate(belief, "Q1", from_utime(9), 3);
  ASSERT_TRUE(estimate);
  EXPECT_EQ(estimate->robot, "Q1");
  EXPECT_EQ(estimate->time, from_utime(9));
  EXPECT_EQ(estimate->last_seen, from_utime(4));
  EXPECT_NEAR(estimate->entropy_nats,
              0.5 * std::log(std::pow(2.0 * std::numbers::pi * std::numbers::e, 3) *
                             covariance.determinant()),
              1e-9);
  EXPECT_NEAR(estimate->sigma_m(), std::sqrt(covariance.trace() / 3.0), 1e-9);
  // An error that equals a column of the covariance's root has eᵀ Σ⁻¹ e = 1.
  for (Eigen::Index column = 0; column < 3; ++column) {
    EXPECT_NEAR(estimate->nees(mean + root.col(column)), 1.0, 1e-9);
    EXPECT_NEAR(estimate->nees(mean - 2.0 * root.col(column)), 4.0, 1e-9);
  }
  EXPECT_NEAR(estimate->nees(mean), 0.0, 1e-12);
  EXPECT_FALSE(position_estimate(belief_with(Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()),
                                 "Q1", Time{}, 3))
      << "a planar belief only";
  EXPECT_NEAR(isotropic_entropy_nats(2.0, 3),
              position_estimate(belief_with(mean, 4.0 * Eigen::Matrix3d::Identity()), "", {}, 3)
                  ->entropy_nats,
              1e-9);
}

TEST(TeamEstimate, SeparatesTargets) {
  TeamEstimate team;
  team.offer(3, {"Q1", Time{}, from_utime(1), {}, {}, 2.0});
  team.offer(4, {"Q2", Time{}, from_utime(1), {}, {}, 1.0});
  EXPECT_EQ(team.find(3)->robot, "Q1");
  EXPECT_EQ(team.find(4)->robot, "Q2");
  EXPECT_EQ(team.find(5), nullptr);
}

}  // namespace
}  // namespace vantage::logs
