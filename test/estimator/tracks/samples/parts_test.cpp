#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "estimator/filter/distributed_filter.hpp"
#include "estimator/tracks/labelled/mixture.hpp"
#include "estimator/tracks/samples/samples.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/estimator/tracks/samples/field_filter.hpp"
#include "test/support/near.hpp"

// Tests of splitting the belief of an unseen target into several Gaussians.

namespace vantage::estimator {
namespace {

using namespace test::words;  // NOLINT(google-build-using-namespace)
using vantage::test::is_near;

constexpr double kSigma_m = 2.0;

/// Returns samples with spread `sigma_m` and zero mean velocity around the centre of the field,
/// after an empty scan of it.
Samples looked_for(double sigma_m, double yaw_rad) {
  Gaussian belief{Eigen::Vector4d::Zero(), Eigen::Matrix4d::Zero()};
  belief.covariance.diagonal() << sigma_m * sigma_m, sigma_m * sigma_m, 0.01, 0.01;
  Samples samples;
  samples.spread(belief);
  samples.miss(test::field_sensor(),
               at(-4.0 * std::cos(yaw_rad), -4.0 * std::sin(yaw_rad), yaw_rad), test::kField, 1.0);
  return samples;
}

double largest_sigma_m(const Component& part) {
  const Eigen::Matrix2d P = part.belief.covariance.topLeftCorner<2, 2>();
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(P).eigenvalues()(1));
}

TEST(Parts, KeepTheMomentsOfTheSamples) {
  for (const double sigma_m : {0.5, 3.0, 9.0}) {
    for (const double yaw_rad : {0.0, 2.0, -1.0}) {
      const Samples samples = looked_for(sigma_m, yaw_rad);
      const Mixture parts = samples.parts(kSigma_m);
      double weight = 0.0;
      for (const Component& part : parts) {
        weight += part.weight;
        EXPECT_GT(part.weight, 0.0);
        EXPECT_EQ(Eigen::LLT<Eigen::Matrix4d>(part.belief.covariance).info(), Eigen::Success);
      }
      EXPECT_NEAR(weight, 1.0, 1e-12);
      EXPECT_LE(parts.size(), static_cast<std::size_t>(Samples::kPartsMax));
      const Gaussian whole = samples.moments();
      const Gaussian together = moments(parts);
      EXPECT_TRUE(is_near(together.mean, whole.mean, 1e-9));
      Eigen::Matrix4d grain = Eigen::Matrix4d::Zero();
      grain.diagonal() << Samples::kGrain_m2, Samples::kGrain_m2, Samples::kGrain_m2ps2,
          Samples::kGrain_m2ps2;
      EXPECT_TRUE(is_near(together.covariance, whole.covariance + grain, 1e-9));
    }
  }
}

TEST(Parts, AreNarrowUnlessTheirNumberIsAtTheMaximum) {
  const double asked_m = std::hypot(kSigma_m, std::sqrt(Samples::kGrain_m2));
  for (const double sigma_m : {1.0, 2.5, 3.0, 4.0, 9.0}) {
    for (const double yaw_rad : {0.7, -0.7, 2.5}) {
      const Mixture parts = looked_for(sigma_m, yaw_rad).parts(kSigma_m);
      const auto is_narrow = [&](const Component& part) { return largest_sigma_m(part) < asked_m; };
      EXPECT_TRUE(parts.size() == Samples::kPartsMax ||
                  std::all_of(parts.begin(), parts.end(), is_narrow))
          << sigma_m;
      EXPECT_EQ(parts.size() > 1, sigma_m > kSigma_m) << sigma_m;
      EXPECT_TRUE(parts.size() == Samples::kPartsMax || sigma_m < 9.0);
    }
  }
}

TEST(Parts, SplitAtTheWidthLimit) {
  for (const double yaw_rad : {0.0, 1.0}) {
    const Samples samples = looked_for(3.0, yaw_rad);
    const double widest_m = largest_sigma_m({1.0, samples.moments()});
    EXPECT_EQ(samples.parts(1.001 * widest_m).size(), 1U);
    EXPECT_EQ(samples.parts(0.999 * widest_m).size(), 2U);
  }
}

// The mean of a ring lies inside it, in the area that an empty scan covered. Plans therefore use
// parts.
TEST(Parts, AvoidEmptyObservedAreas) {
  const models::SensorModel sensor = test::field_sensor();
  for (const double yaw_rad : {0.0, 1.0, -2.5}) {
    const models::Viewpoint from = at(-4.0 * std::cos(yaw_rad), -4.0 * std::sin(yaw_rad), yaw_rad);
    const Samples samples = looked_for(6.0, yaw_rad);
    double seen = 0.0;
    for (const Component& part : samples.parts(kSigma_m)) {
      const models::PositionVector mean_m = part.belief.mean.head<2>();
      seen += models::in_view(sensor, from, mean_m) ? part.weight : 0.0;
    }
    EXPECT_LT(seen, 0.3) << yaw_rad;
  }
}

TEST(MixtureOfAFilter, ContainsUnseenWideTargets) {
  DistributedFilter filter = test::knows(test::kNearACorner);
  EXPECT_TRUE(filter.mixture().targets.empty()) << "a Gaussian, as received";
  for (int k = 1; k <= 40; ++k) {
    const models::Viewpoint from = test::beside(test::kNearACorner, k);
    take_step(filter, instant(k), from, {test::look_of("Q1", k, from)});
  }
  const models::BeliefMixture mixture = filter.mixture();
  EXPECT_EQ(mixture.stamp.time, instant(40));
  EXPECT_EQ(mixture.robot, filter.spec().robot);
  ASSERT_EQ(mixture.targets.size(), 1U);
  EXPECT_EQ(mixture.targets[0].target_id, 0);
  EXPECT_EQ(mixture.targets[0].existence, 1.0);
  const Gaussian published = known(filter, 0);
  EXPECT_TRUE(is_near(moments(mixture.targets[0].components).mean, published.mean, 1e-6));
  EXPECT_GT(mixture.targets[0].components.size(), 2U);
  for (const Component& part : mixture.targets[0].components) {
    EXPECT_LT(largest_sigma_m(part), 0.75 * largest_sigma_m({1.0, published}));
  }
  const Eigen::Vector2d truth_m = published.mean.head<2>();
  const models::Viewpoint from = at(truth_m.x() - 5.0, truth_m.y(), 0.0);
  models::RobotMeasurement look = test::look_of("Q1", 41, from);
  look.detections.push_back({0, test::seen(from, truth_m)});
  take_step(filter, instant(41), from, {look});
  EXPECT_TRUE(filter.mixture().targets.empty()) << "the target has been seen";
}

// Beliefs wider than a fifth of the sensor's range, 2 m, are split: narrower ones are covered by
// one scan.
TEST(MixtureOfAFilter, ContainsTargetsWiderThanAFifthOfTheRange) {
  for (const auto& [sigma_m, is_wide] : {std::pair(1.9, false), std::pair(2.1, true)}) {
    Gaussian belief{Eigen::Vector4d::Zero(), Eigen::Matrix4d::Zero()};
    belief.covariance.diagonal() << sigma_m * sigma_m, 1.0, 0.01, 0.01;
    DistributedFilter filter = test::knows(belief);
    const models::Viewpoint from = at(0.0, -12.0, 0.5 * kPi);  // covers little of the belief
    take_step(filter, instant(1), from, {test::look_of("Q1", 1, from)});
    ASSERT_GT(filter.counters().missed_detections, 0);
    const models::BeliefMixture mixture = filter.mixture();
    EXPECT_EQ(mixture.targets.size(), is_wide ? 1U : 0U) << known(filter, 0).covariance(0, 0);
    if (is_wide) {
      EXPECT_EQ(mixture.targets[0].components.size(), 2U);
    }
  }
}

}  // namespace
}  // namespace vantage::estimator
