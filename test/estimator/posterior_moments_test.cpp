#include "estimator/posterior_moments.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "test/estimator/filter_support.hpp"

// At the edges; track_test holds it against brute force between them.

namespace vantage::estimator {
namespace {

using test::at;
using test::far_sighted;

models::Measurement one(double z, double sigma) {
  return {Eigen::Matrix<double, 1, 1>(z), Eigen::Matrix<double, 1, 1>(sigma * sigma)};
}

// Then p falls from the robot on, in all directions: what counts is near, though p is wide.
TEST(PosteriorMoments, OfARangeBelowZeroAreAroundTheRobot) {
  const double prior_sigma_m = 0.5;
  const double sigma_m = 0.1;
  const double z_m = -0.8;
  const auto found = posterior_moments(
      {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity() / (prior_sigma_m * prior_sigma_m)},
      far_sighted(models::SensorKind::kRange), at(0.0, 0.0), one(z_m, sigma_m));
  ASSERT_TRUE(found);
  double mass = 0.0;
  double squares = 0.0;
  for (double r = 5e-6; r < 1.0; r += 1e-5) {
    const double off_m = (z_m - r) / sigma_m;
    const double p =
        r * std::exp(-0.5 * (r * r / (prior_sigma_m * prior_sigma_m) + off_m * off_m) + 32.0);
    mass += p;
    squares += p * r * r;
  }
  EXPECT_LT(found->mean_m.norm(), 1e-9);
  EXPECT_NEAR(found->covariance_m2.trace(), squares / mass, 0.003 * squares / mass);
}

// Less than a whole turn: each direction counts once.
TEST(PosteriorMoments, OfABearingThatSaysNothingAreThoseOfThePrior) {
  const Eigen::Vector2d mean_m(2.0, 0.5);
  const Eigen::Matrix2d P = Eigen::Vector2d(0.16, 0.04).asDiagonal();
  for (const double sigma_rad : {20.0, 200.0}) {
    const auto found =
        posterior_moments({mean_m, P.inverse()}, far_sighted(models::SensorKind::kBearing),
                          at(0.0, 0.0), one(1.0, sigma_rad));
    ASSERT_TRUE(found);
    EXPECT_LT((found->mean_m - mean_m).norm(), 2e-3) << sigma_rad;
    EXPECT_LT((found->covariance_m2 - P).norm(), 1e-3) << sigma_rad;
  }
}

// Of a prior of 10⁸⁰ m the mean is a number, its square none.
TEST(PosteriorMoments, AreNoneWhereTheyAreBeyondNumbers) {
  const auto moments = [](double information) {
    return posterior_moments({Eigen::Vector2d(2.0, 0.5), information * Eigen::Matrix2d::Identity()},
                             far_sighted(models::SensorKind::kBearing), at(0.0, 0.0),
                             one(0.2, 0.1));
  };
  EXPECT_TRUE(moments(1e-20));
  EXPECT_FALSE(moments(1e-160));
}

}  // namespace
}  // namespace vantage::estimator
