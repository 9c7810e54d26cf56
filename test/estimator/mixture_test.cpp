#include "estimator/mixture.hpp"

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

TEST(Moments, AreThoseOfTheSum) {
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

TEST(Reduce, KeepsWeightMeanAndCovarianceOfTheWhole) {
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

TEST(Reduce, DropsWhatWeighsNothingButNeverTheHeaviest) {
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

}  // namespace
}  // namespace vantage::estimator
