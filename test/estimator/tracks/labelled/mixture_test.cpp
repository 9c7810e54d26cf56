#include "estimator/tracks/labelled/mixture.hpp"

#include <utility>

#include <gtest/gtest.h>

#include "test/support/near.hpp"
#include "test/support/random.hpp"

namespace vantage::estimator {
namespace {

using vantage::test::is_near;

Mixture random_mixture(test::Random& random, int count) {
  Mixture mixture;
  for (int i = 0; i < count; ++i) {
    models::Gaussian belief{random.vector<4>(-3.0, 3.0), random.spd(4, 0.1)};
    mixture.push_back({random.uniform(0.01, 1.0), belief});
  }
  return mixture;
}

TEST(Moments, EqualTheMomentsOfTheMixture) {
  test::Random random(1);
  const Mixture mixture = random_mixture(random, 5);
  double weight = 0.0;
  Eigen::Vector4d mean = Eigen::Vector4d::Zero();
  Eigen::Matrix4d square = Eigen::Matrix4d::Zero();
  for (const Component& c : mixture) {
    weight += c.weight;
    mean += c.weight * c.belief.mean;
    square += c.weight * (c.belief.covariance + c.belief.mean * c.belief.mean.transpose());
  }
  mean /= weight;
  const models::Gaussian whole = moments(mixture);
  EXPECT_TRUE(is_near(whole.mean, mean, 1e-12));
  EXPECT_TRUE(is_near(whole.covariance, square / weight - mean * mean.transpose(), 1e-12));
}

TEST(Reduce, KeepsTotalWeightMeanAndCovariance) {
  test::Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    Mixture mixture = random_mixture(random, random.integer(1, 12));
    const models::Gaussian before = moments(mixture);
    double weight = 0.0;
    for (const Component& c : mixture) {
      weight += c.weight;
    }
    reduce(mixture, 3, random.uniform(0.0, 4.0), 0.0);
    ASSERT_LE(mixture.size(), 3U);
    double after = 0.0;
    for (std::size_t i = 0; i < mixture.size(); ++i) {
      after += mixture[i].weight;
      EXPECT_TRUE(i == 0 || mixture[i].weight <= mixture[i - 1].weight);
    }
    EXPECT_NEAR(after, weight, 1e-12);
    EXPECT_TRUE(is_near(moments(mixture).mean, before.mean, 1e-9));
    EXPECT_TRUE(is_near(moments(mixture).covariance, before.covariance, 1e-9));
  }
}

TEST(Reduce, DropsZeroWeightsButKeepsTheHeaviest) {
  test::Random random(3);
  Mixture mixture = random_mixture(random, 3);
  mixture[0].weight = 1e-9;
  mixture[1].weight = 0.5;
  mixture[2].weight = 0.4;
  reduce(mixture, 3, 0.0, 1e-3);
  ASSERT_EQ(mixture.size(), 2U);
  EXPECT_NEAR(mixture[0].weight + mixture[1].weight, 0.9 + 1e-9, 1e-12);
  reduce(mixture, 3, 0.0, 0.99);
  EXPECT_EQ(mixture.size(), 1U);
}

Component at_x(double weight, double x_m, double sigma_m) {
  return {weight, {Eigen::Vector2d(x_m, 0.0), sigma_m * sigma_m * Eigen::Matrix2d::Identity()}};
}

TEST(Moments, IgnoreZeroWeights) {
  const Component one = at_x(0.3, 2.0, 0.5);
  const Mixture mixture = {at_x(0.0, -7.0, 3.0), at_x(0.0, 5.0, 2.0), one, at_x(0.0, 1.0, 9.0)};
  EXPECT_TRUE(is_near(moments(mixture).mean, one.belief.mean, 1e-12));
  EXPECT_TRUE(is_near(moments(mixture).covariance, one.belief.covariance, 1e-12));
}

// Distances are in σ of the heavier component's covariance, for either order.
TEST(Reduce, MergesComponentsWithinTheGivenSigma) {
  for (const double other_sigma_m : {0.05, 5.0}) {
    for (const double side : {-1.0, 1.0}) {
      for (const bool is_lighter_first : {false, true}) {
        const auto left = [&](double away_m) {
          Mixture mixture = {at_x(0.6, 0.0, 0.5), at_x(0.4, side * away_m, other_sigma_m)};
          if (is_lighter_first) {
            std::swap(mixture[0], mixture[1]);
          }
          reduce(mixture, 8, 2.0, 0.0);
          return mixture.size();
        };
        EXPECT_EQ(left(0.999), 1U);
        EXPECT_EQ(left(1.001), 2U);
      }
    }
  }
}

// Merging increases a component's covariance but not its merge distance.
TEST(Reduce, MergingDoesNotExtendTheMergeDistance) {
  Mixture mixture = {at_x(0.5, 0.0, 0.5), at_x(0.3, 0.9, 0.5), at_x(0.2, 1.1, 0.5)};
  reduce(mixture, 8, 2.0, 0.0);
  ASSERT_EQ(mixture.size(), 2U);
  EXPECT_NEAR(mixture[0].weight, 0.8, 1e-12);
  EXPECT_NEAR(mixture[0].belief.mean(0), 0.3 * 0.9 / 0.8, 1e-12);
  EXPECT_EQ(mixture[1].belief.mean(0), 1.1);
}

// The nearest component is that with the smallest distance in σ of its own covariance. A wide
// component is therefore near at a larger distance.
TEST(Reduce, MergesExcessComponentsWithTheNearest) {
  for (const auto& [wide_m, is_to_wide] : {std::pair(1.0, false), std::pair(4.0, true)}) {
    Mixture mixture = {at_x(1.5, 0.0, wide_m), at_x(0.9, 10.0, 1.0), at_x(0.75, 6.0, 1.0),
                       at_x(0.03, -90.0, 1.0)};
    reduce(mixture, 2, 0.1, 0.02);
    ASSERT_EQ(mixture.size(), 2U);
    const double total = 1.5 + 0.9 + 0.75 + 0.03;  // the dropped weight is redistributed
    EXPECT_NEAR(mixture[0].weight + mixture[1].weight, total, 1e-12);
    const double heavier = is_to_wide ? 1.5 + 0.75 : 0.9 + 0.75;
    EXPECT_NEAR(mixture[0].weight, total * heavier / 3.15, 1e-12);
    EXPECT_NEAR(mixture[0].belief.mean(0), is_to_wide ? 2.0 : (9.0 + 4.5) / 1.65, 1e-12);
  }
}

TEST(Reduce, DropsComponentsBelowTheWeightLimit) {
  for (const auto& [least, left] : {std::pair(0.25, 2U), std::pair(0.2501, 1U)}) {
    Mixture mixture = {at_x(1.0, 9.0, 1.0), at_x(3.0, 0.0, 1.0)};
    reduce(mixture, 2, 0.1, least);
    EXPECT_EQ(mixture.size(), left);
    EXPECT_EQ(mixture[0].belief.mean(0), 0.0);
    EXPECT_NEAR(mixture[0].weight, left == 2U ? 3.0 : 4.0, 1e-12);
  }
}

}  // namespace
}  // namespace vantage::estimator
