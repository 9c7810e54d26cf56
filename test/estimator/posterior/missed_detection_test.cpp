#include "estimator/posterior/missed_detection.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "estimator/posterior/moment_matching.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/support/near.hpp"

namespace vantage::estimator {
namespace {

using models::Gaussian;
using test::at;
using vantage::test::is_near;

const models::World kOpen{{{-20.0, -20.0}, {20.0, 20.0}}, 10.0, {}, {}};

models::SensorModel disc(double range_max_m) {
  models::SensorModel sensor;
  sensor.range_max_m = range_max_m;
  return sensor;
}

Gaussian standard() { return {Eigen::Vector2d(2.0, 0.0), Eigen::Matrix2d::Identity()}; }

TEST(ProductRule, ReachCoversTheFarthestPoint) {
  models::PositionMatrix L = models::PositionMatrix::Zero(2, 2);
  L << 0.5, 0.0, -0.2, 0.3;
  const ProductRule& rule = ProductRule::of(2);
  double farthest_m = 0.0;
  for (int i = 0; i < rule.size; ++i) {
    for (int j = 0; j < rule.size; ++j) {
      const Eigen::Vector2d u(rule.point[static_cast<std::size_t>(i)],
                              rule.point[static_cast<std::size_t>(j)]);
      farthest_m = std::max(farthest_m, (L * u).norm());
    }
  }
  EXPECT_GE(rule.reach_m(L), farthest_m - 1e-12);
  EXPECT_LE(rule.reach_m(L), 1.5 * farthest_m);
}

TEST(MissedDetection, ChangesNothingOutsideTheView) {
  const Gaussian belief = standard();
  const Gaussian after = missed_detection(belief, disc(1.0), at(-10, 0), kOpen, 0.9);
  EXPECT_EQ(after.mean, belief.mean);
  EXPECT_EQ(after.covariance, belief.covariance);
  EXPECT_EQ(missed_detection(belief, disc(1.0), at(2, 0), kOpen, 0.0).mean, belief.mean);
}

TEST(MissedDetection, ChangesNothingWhenTheBeliefIsFullyInView) {
  const Gaussian belief = standard();
  const Gaussian after = missed_detection(belief, disc(50.0), at(0, 0), kOpen, 0.9);
  EXPECT_TRUE(is_near(after.mean, belief.mean, 1e-12));
  EXPECT_TRUE(is_near(after.covariance, belief.covariance, 1e-12));
}

TEST(MissedDetection, EqualsTheTruncatedNormalForAHalfPlane) {
  // A distant sensor with a wide field of view covers x < 2 + a of N((2, 0), I) and has p_D = 1.
  // The belief is truncated to u > a: mean λ = φ(a)/(1 − Φ(a)), variance 1 + aλ − λ². The edge is
  // midway between two columns of the rule.
  const double far_m = 1000.0;
  const double a = 0.217;
  const Gaussian after =
      missed_detection(standard(), disc(far_m), at(2.0 + a - far_m, 0.0), kOpen, 1.0);
  const double lambda =
      std::exp(-0.5 * a * a) / std::sqrt(2.0 * kPi) / (0.5 * std::erfc(a / std::sqrt(2.0)));
  EXPECT_NEAR(after.mean(0), 2.0 + lambda, 0.03);
  EXPECT_NEAR(after.covariance(0, 0), 1.0 + a * lambda - lambda * lambda, 0.03);
  EXPECT_NEAR(after.mean(1), 0.0, 1e-6);
  EXPECT_NEAR(after.covariance(1, 1), 1.0, 0.02);
}

TEST(MissedDetection, WidensABeliefAroundAnObservedCentre) {
  const Gaussian after = missed_detection(standard(), disc(1.0), at(2, 0), kOpen, 0.9);
  EXPECT_TRUE(is_near(after.mean, standard().mean, 1e-12));
  // Integrals over the covered disc in closed form: Z = 1 − p(1 − e^−½), E[r²] = 2 − p(2 − 3e^−½).
  const double p = 0.9;
  const double Z = 1.0 - p * (1.0 - std::exp(-0.5));
  const double variance = 0.5 * (2.0 - p * (2.0 - 3.0 * std::exp(-0.5))) / Z;
  EXPECT_NEAR(after.covariance(0, 0), variance, 0.05);
  EXPECT_NEAR(after.covariance(1, 1), variance, 0.05);
}

TEST(MissedDetection, RespectsLineOfSight) {
  models::World walled = kOpen;
  walled.obstacles.push_back({{{-1.0, -15.0}, {-0.8, 15.0}}, 10.0});
  const Gaussian after = missed_detection(standard(), disc(50.0), at(-10, 0), walled, 0.9);
  // The sensor covers only the few quadrature points on its side of the wall.
  EXPECT_TRUE(is_near(after.mean, standard().mean, 0.05));
  const Gaussian open = missed_detection(standard(), disc(10.0), at(-8.5, 0), kOpen, 0.9);
  EXPECT_GT(open.mean(0), after.mean(0) + 0.2);
}

TEST(MissedDetection, UpdatesTheCorrelatedVelocity) {
  Gaussian belief{Eigen::Vector4d(2.0, 0.0, 0.0, 0.0), Eigen::Matrix4d::Identity()};
  belief.covariance(0, 2) = belief.covariance(2, 0) = 0.8;
  const Gaussian after = missed_detection(belief, disc(1000.0), at(-998.0, 0), kOpen, 0.9);
  EXPECT_NEAR(after.mean(2), 0.8 * (after.mean(0) - 2.0), 1e-12);
  EXPECT_EQ(after.mean(3), 0.0);
}

TEST(MissedDetection, IsConsistentOverTruthsDrawnFromTheBelief) {
  // Truths are drawn from the prior and scans have p_D = 0.9. For scans without a detection the
  // posterior's moments must be correct: mean NEES = 2 within its sampling error.
  std::mt19937_64 rng(77);
  std::bernoulli_distribution detects(0.9);
  const models::SensorModel sensor = disc(1.5);
  const auto from = at(1.0, 0.3);
  const Gaussian after = missed_detection(standard(), sensor, from, kOpen, 0.9);
  const Eigen::Matrix2d precision = Eigen::Matrix2d(after.covariance).inverse();
  double nees = 0.0;
  Eigen::Vector2d mean_error = Eigen::Vector2d::Zero();
  int missed = 0;
  while (missed < 20'000) {
    const Eigen::Vector2d y_m = standard().mean + test::normal_vector(2, rng);
    if (models::in_view(sensor, from, y_m) && detects(rng)) {
      continue;
    }
    const Eigen::Vector2d error = y_m - after.mean;
    nees += error.dot(precision * error);
    mean_error += error;
    ++missed;
  }
  EXPECT_NEAR(nees / missed, 2.0, 0.06);
  EXPECT_LT((mean_error / missed).norm(), 0.05);
}

// Scenario and sensor both have a detection probability; the smaller one is used.
TEST(DistributedFilter, WeightsAMissByTheSensorsMissProbability) {
  const Gaussian before = standard();
  for (const auto& [of_scenario, of_sensor] : {std::pair(0.9, 0.6), std::pair(0.6, 0.9)}) {
    FilterSpec spec = test::open_spec({models::TargetKind::kStatic, 2, 0.0},
                                      test::far_sighted(models::SensorKind::kRangeBearing), 1);
    spec.sensor.range_max_m = 1.5;  // m; covers a part of the belief
    spec.estimator.detection_probability = of_scenario;
    spec.detection.detection_probability = of_sensor;
    DistributedFilter filter(spec);
    filter.rebase(test::prior(test::instant(0), {before}));
    models::RobotMeasurement nothing;
    nothing.stamp.time = test::instant(1);
    nothing.robot = spec.robot;
    nothing.viewpoint = at(1.0, 0.3);
    test::take_step(filter, test::instant(1), at(1.0, 0.3), {nothing});
    const Gaussian expected = missed_detection(before, spec.sensor, at(1.0, 0.3), spec.world, 0.6);
    EXPECT_TRUE(is_near(test::known(filter, 0).mean, expected.mean, 1e-9));
    EXPECT_TRUE(is_near(test::known(filter, 0).covariance, expected.covariance, 1e-9));
    EXPECT_GT((expected.mean - before.mean).norm(), 0.1);
  }
}

TEST(MissedDetection, StaysSymmetricAndPositiveDefinite) {
  std::mt19937_64 rng(78);
  std::uniform_real_distribution<double> place(-3.0, 3.0);
  for (int trial = 0; trial < 300; ++trial) {
    const int n = trial % 3 == 0 ? 2 : trial % 3 == 1 ? 3 : 4;
    Gaussian belief{2.0 * test::normal_vector(n, rng), models::StateMatrix::Zero(n, n)};
    for (int i = 0; i < n + 1; ++i) {
      const models::StateVector v = test::normal_vector(n, rng);
      belief.covariance += v * v.transpose();
    }
    const auto from = at(place(rng), place(rng), place(rng));
    models::SensorModel sensor = disc(3.0);
    sensor.fov_rad = radians(94.0);
    for (int look = 0; look < 10; ++look) {  // repeats the same scan
      belief = missed_detection(belief, sensor, from, kOpen, 1.0);
      ASSERT_EQ(belief.covariance, belief.covariance.transpose());
      ASSERT_TRUE(models::to_information(belief));
      ASSERT_TRUE(belief.mean.allFinite());
    }
  }
}

// The robots of the team have different ranges and detection probabilities.
TEST(DistributedFilter, WeightsATeammatesMissByItsSensor) {
  const Gaussian before = standard();
  FilterSpec spec = test::open_spec({models::TargetKind::kStatic, 2, 0.0},
                                    test::far_sighted(models::SensorKind::kRangeBearing), 1);
  spec.sensor.range_max_m = 1.1;
  spec.detection.detection_probability = 0.5;
  spec.estimator.detection_probability = 0.8;
  spec.communication_range_m = 100.0;
  spec.team = {{"Q2", disc(1.5), {0.6}}, {"Q1", spec.sensor, {0.1}}, {"Q3", disc(2.0), {0.95}}};
  const models::Viewpoint from = at(1.0, 0.3);
  const auto after = [&](const std::string& robot) {
    DistributedFilter filter(spec);
    filter.rebase(test::prior(test::instant(0), {before}));
    models::RobotMeasurement nothing;
    nothing.stamp.time = test::instant(1);
    nothing.robot = robot;
    nothing.viewpoint = from;
    test::take_step(filter, test::instant(1), at(0.0, 0.0), {nothing});
    EXPECT_EQ(filter.counters().missed_detections, 1);
    return test::known(filter, 0);
  };
  const auto expect = [&](const std::string& robot, double reach_m, double probability) {
    const Gaussian right = missed_detection(before, disc(reach_m), from, spec.world, probability);
    EXPECT_TRUE(is_near(after(robot).mean, right.mean, 1e-9)) << robot;
    EXPECT_TRUE(is_near(after(robot).covariance, right.covariance, 1e-9)) << robot;
  };
  expect("Q1", 1.1, 0.5);  // the filter's spec overrides its team entry
  expect("Q2", 1.5, 0.6);
  expect("Q3", 2.0, 0.8);
  expect("Q9", 1.1, 0.5);  // not in the team
}

}  // namespace
}  // namespace vantage::estimator
