#include "estimator/ranges/range_only.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <random>
#include <sstream>
#include <utility>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "test/estimator/csv.hpp"

namespace vantage::estimator {
namespace {

using test::read_csv;

TEST(RangeOnlyFilter, StartsWithARing) {
  RangeOnlySpec spec;
  spec.calibration = {2.0, 1.0};
  RangeOnlyFilter filter(spec);
  EXPECT_EQ(filter.best().weight, 0.0);
  filter.update({3.0, 4.0}, 21.0);  // (21 − 1)/2 = 10 m
  ASSERT_EQ(filter.hypotheses().size(), 48u);
  for (const BeaconHypothesis& h : filter.hypotheses()) {
    EXPECT_NEAR((h.mean_m - Eigen::Vector2d(3.0, 4.0)).norm(), 10.0, 1e-9);
  }
}

TEST(RangeOnlyFilter, KeepsBothMirrorImagesUntilTheRobotTurns) {
  RangeOnlySpec spec;
  spec.range_sigma_m = 0.1;
  RangeOnlyFilter filter(spec);
  const Eigen::Vector2d beacon_m(10.0, 6.0);
  std::mt19937_64 rng(1);
  std::normal_distribution<double> noise(0.0, 0.1);
  for (int k = 0; k <= 100; ++k) {  // along the x axis: y and −y fit equally
    const Eigen::Vector2d robot_m(0.1 * k, 0.0);
    filter.update(robot_m, (beacon_m - robot_m).norm() + noise(rng));
  }
  const auto sees = [&](double y_m) {
    for (const BeaconHypothesis& h : filter.hypotheses()) {
      if ((h.mean_m - Eigen::Vector2d(10.0, y_m)).norm() < 0.5) {
        return true;
      }
    }
    return false;
  };
  EXPECT_TRUE(sees(6.0));
  EXPECT_TRUE(sees(-6.0));
  for (int k = 0; k <= 50; ++k) {
    const Eigen::Vector2d robot_m(10.0, 0.1 * k);
    filter.update(robot_m, (beacon_m - robot_m).norm() + noise(rng));
  }
  EXPECT_EQ(filter.hypotheses().size(), 1u);
  EXPECT_LT((filter.best().mean_m - beacon_m).norm(), 0.1);
}

TEST(RangeOnlyFilter, FindsABeaconAmongOutliersFromEverySide) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937_64 rng(seed);
    std::normal_distribution<double> noise(0.0, 0.3);
    std::bernoulli_distribution is_outlier(0.1);
    std::uniform_real_distribution<double> anything(0.0, 60.0);
    std::uniform_real_distribution<double> direction(-kPi, kPi);
    const double bearing_rad = direction(rng);
    const Eigen::Vector2d beacon_m =
        25.0 * Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad));
    RangeOnlySpec spec;
    spec.range_sigma_m = 0.3;
    spec.outlier_share = 0.1;
    RangeOnlyFilter filter(spec);
    for (int k = 0; k < 400; ++k) {
      const Eigen::Vector2d robot_m(15.0 * std::cos(0.03 * k), 15.0 * std::sin(0.03 * k));
      const double honest_m = (beacon_m - robot_m).norm() + noise(rng);
      filter.update(robot_m, is_outlier(rng) ? anything(rng) : honest_m);
    }
    EXPECT_LT((filter.best().mean_m - beacon_m).norm(), 0.15) << "seed " << seed;
    EXPECT_LE(filter.hypotheses().size(), 2u) << "seed " << seed;
  }
}

// A known bias has no effect on the result.
TEST(RangeOnlyFilter, CompensatesABias) {
  const Eigen::Vector2d beacon_m(9.0, -4.0);
  std::mt19937_64 rng(7);
  std::normal_distribution<double> noise(0.0, 0.2);
  RangeOnlySpec spec;
  spec.range_sigma_m = 0.2;
  RangeOnlyFilter plain(spec);
  spec.calibration.range_bias_m = 1.5;
  RangeOnlyFilter biased(spec);
  for (int k = 0; k < 80; ++k) {
    const Eigen::Vector2d robot_m(5.0 * std::cos(0.1 * k), 5.0 * std::sin(0.1 * k));
    const double range_m = (beacon_m - robot_m).norm() + noise(rng);
    plain.update(robot_m, range_m);
    biased.update(robot_m, range_m + 1.5);
  }
  EXPECT_LT((plain.best().mean_m - beacon_m).norm(), 0.2);
  EXPECT_LT((biased.best().mean_m - plain.best().mean_m).norm(), 1e-9);
  EXPECT_EQ(biased.restarts(), 0);
}

TEST(RangeOnlyFilter, RestartsWhenTheFirstRangeWasAnOutlier) {
  RangeOnlySpec spec;
  RangeOnlyFilter filter(spec);
  const Eigen::Vector2d beacon_m(-20.0, 10.0);
  filter.update({0.0, 0.0}, 90.0);
  for (int k = 0; k < 300; ++k) {
    const Eigen::Vector2d robot_m(10.0 * std::cos(0.05 * k), 10.0 * std::sin(0.05 * k));
    filter.update(robot_m, (beacon_m - robot_m).norm());
  }
  EXPECT_GE(filter.restarts(), 1);
  EXPECT_LT((filter.best().mean_m - beacon_m).norm(), 0.3);
}

TEST(RangeOnlyFilter, RefusesInvalidRanges) {
  RangeOnlyFilter filter({});
  filter.update({0.0, 0.0}, std::numeric_limits<double>::quiet_NaN());
  filter.update({0.0, 0.0}, -1.0);
  EXPECT_EQ(filter.refused(), 2);
  RangeOnlySpec spec;
  spec.hypotheses = 3;
  EXPECT_THROW(RangeOnlyFilter{spec}, UsageError);
}

/// Returns the spec of a filter that neither drops nor merges hypotheses.
RangeOnlySpec keeping_all(int hypotheses) {
  RangeOnlySpec spec;
  spec.hypotheses = hypotheses;
  spec.weight_min = 0.0;
  spec.merge_distance_sigma = 0.0;
  return spec;
}

/// Returns the posterior of a hypothesis. It combines the moments of two cases, outlier and inlier.
/// For an inlier, a textbook second-order Kalman filter updates the hypothesis.
BeaconHypothesis posterior_of(const BeaconHypothesis& prior, const RangeOnlySpec& spec,
                              const Eigen::Vector2d& robot_m, double range_m) {
  const double s = spec.calibration.range_scale;
  const Eigen::Vector2d away_m = prior.mean_m - robot_m;
  const double d_m = away_m.norm();
  const Eigen::Vector2d u = away_m / d_m;
  const Eigen::Matrix2d P = prior.covariance_m2;
  const Eigen::Matrix2d bend = s / d_m * (Eigen::Matrix2d::Identity() - u * u.transpose()) * P;
  const double S =
      s * s * u.dot(P * u) + std::pow(spec.range_sigma_m, 2) + 0.5 * (bend * bend).trace();
  const double nu = range_m - (s * d_m + spec.calibration.range_bias_m + 0.5 * bend.trace());
  const double honest =
      (1.0 - spec.outlier_share) * std::exp(-0.5 * nu * nu / S) / std::sqrt(2.0 * kPi * S);
  const double any = honest + spec.outlier_share / spec.outlier_span_m;
  const Eigen::Vector2d K = s * P * u / S;
  const Eigen::Vector2d moved_m = K * nu;
  const double beta = honest / any;
  const Eigen::Vector2d mean_m = beta * moved_m;
  Eigen::Matrix2d square = beta * (P - S * K * K.transpose() + moved_m * moved_m.transpose());
  square += (1.0 - beta) * P;
  return {prior.weight * any, prior.mean_m + mean_m, square - mean_m * mean_m.transpose()};
}

TEST(RangeOnlyFilter, UpdatesEachHypothesis) {
  RangeOnlySpec spec = keeping_all(9);
  spec.calibration = {1.3, 0.7};
  spec.outlier_share = 0.2;
  spec.outlier_span_m = 50.0;
  for (const double range_m : {4.0, 7.0, 11.0}) {
    RangeOnlyFilter filter(spec);
    filter.update({1.0, 2.0}, 6.0);
    std::vector<BeaconHypothesis> expected;
    const Eigen::Vector2d robot_m(3.2, -1.1);
    double total = 0.0;
    for (const BeaconHypothesis& hypothesis : filter.hypotheses()) {
      expected.push_back(posterior_of(hypothesis, spec, robot_m, range_m));
      total += expected.back().weight;
    }
    std::sort(expected.begin(), expected.end(),
              [](const auto& a, const auto& b) { return a.weight > b.weight; });
    filter.update(robot_m, range_m);
    ASSERT_EQ(filter.hypotheses().size(), 9u);
    for (std::size_t i = 0; i < 9; ++i) {
      const BeaconHypothesis& made = filter.hypotheses()[i];
      EXPECT_NEAR(made.weight, expected[i].weight / total, 1e-12);
      EXPECT_LT((made.mean_m - expected[i].mean_m).norm(), 1e-9);
      EXPECT_LT((made.covariance_m2 - expected[i].covariance_m2).norm(), 1e-9);
      EXPECT_EQ(made.covariance_m2(0, 1), made.covariance_m2(1, 0));
    }
    EXPECT_EQ(filter.best().weight, filter.hypotheses()[0].weight);
    EXPECT_EQ(filter.best().mean_m, filter.hypotheses()[0].mean_m);
  }
}

double density_at(const std::vector<BeaconHypothesis>& all, const Eigen::Vector2d& y_m) {
  double sum = 0.0;
  for (const BeaconHypothesis& h : all) {
    const Eigen::Vector2d off_m = y_m - h.mean_m;
    sum += h.weight / (2.0 * kPi * std::sqrt(h.covariance_m2.determinant())) *
           std::exp(-0.5 * off_m.dot(h.covariance_m2.inverse() * off_m));
  }
  return sum;
}

// The ring of hypotheses is uniform, at the calibrated distance and with its σ, for any scale.
TEST(RangeOnlyFilter, StartsWithAUniformRingAsWideAsTheNoise) {
  RangeOnlySpec spec;
  spec.calibration.range_scale = 2.0;
  spec.range_sigma_m = 1.0;
  const Eigen::Vector2d robot_m(3.0, -4.0);
  constexpr double kSigma_m = 0.5;
  for (const double distance_m : {2.5, 8.0, 14.0}) {
    RangeOnlyFilter filter(spec);
    filter.update(robot_m, 2.0 * distance_m);
    double least = 1e9;
    double most = 0.0;
    double mass = 0.0;
    double mean_m = 0.0;
    double square_m2 = 0.0;
    for (int k = 0; k < 97; ++k) {
      const double angle_rad = 2.0 * kPi * k / 97;
      const Eigen::Vector2d u(std::cos(angle_rad), std::sin(angle_rad));
      const double here = density_at(filter.hypotheses(), robot_m + distance_m * u);
      least = std::min(least, here);
      most = std::max(most, here);
      for (double off_m = -2.4; off_m <= 2.4; off_m += 0.05) {
        const double r_m = distance_m + off_m;
        const double p = r_m * density_at(filter.hypotheses(), robot_m + r_m * u);
        mass += p;
        mean_m += p * off_m;
        square_m2 += p * off_m * off_m;
      }
    }
    EXPECT_GT(least / most, 0.99) << distance_m;
    mean_m /= mass;
    const double sigma_m = std::sqrt(square_m2 / mass - mean_m * mean_m);
    EXPECT_NEAR(sigma_m, kSigma_m, 0.03 * kSigma_m) << distance_m;
    for (const BeaconHypothesis& h : filter.hypotheses()) {
      EXPECT_NEAR(h.weight, 1.0 / 48.0, 1e-15);
      const Eigen::Vector2d out = (h.mean_m - robot_m).normalized();
      const Eigen::Vector2d along(-out.y(), out.x());
      EXPECT_NEAR(out.dot(h.covariance_m2 * along), 0.0, 1e-12)
          << "principal axes along and across the ring";
      // The radial spread consists of the noise and the depth of the arc over 1σ along it.
      const double along_m2 = along.dot(h.covariance_m2 * along);
      const double depth_m = distance_m * (1.0 - std::cos(std::sqrt(along_m2) / distance_m));
      EXPECT_NEAR(out.dot(h.covariance_m2 * out) - kSigma_m * kSigma_m, depth_m * depth_m,
                  0.05 * depth_m * depth_m);
      EXPECT_GE(along.dot(h.covariance_m2 * along), kSigma_m * kSigma_m - 1e-12);
    }
  }
  // If the distance is below the noise, the beacon may be in any direction, and no hypothesis is
  // degenerate.
  RangeOnlyFilter near(spec);
  near.update(robot_m, 0.1);
  for (const BeaconHypothesis& h : near.hypotheses()) {
    EXPECT_NEAR(h.covariance_m2.trace(), (2.0 + 1.0) * kSigma_m * kSigma_m, 1e-9);
  }
}

/// Returns the mean and covariance of all hypotheses together.
BeaconHypothesis whole(const std::vector<BeaconHypothesis>& all) {
  BeaconHypothesis sum{0.0, Eigen::Vector2d::Zero(), Eigen::Matrix2d::Zero()};
  for (const BeaconHypothesis& h : all) {
    sum.weight += h.weight;
    sum.mean_m += h.weight * h.mean_m;
    sum.covariance_m2 += h.weight * (h.covariance_m2 + h.mean_m * h.mean_m.transpose());
  }
  sum.covariance_m2 -= sum.mean_m * sum.mean_m.transpose();
  return sum;
}

TEST(RangeOnlyFilter, MergingKeepsTheMoments) {
  RangeOnlySpec spec = keeping_all(48);
  RangeOnlyFilter all(spec);
  spec.merge_distance_sigma = 2.0;
  RangeOnlyFilter fewer(spec);
  for (RangeOnlyFilter* filter : {&all, &fewer}) {
    filter->update({1.0, 2.0}, 9.0);
    filter->update({6.0, 3.0}, 8.0);
  }
  EXPECT_EQ(all.hypotheses().size(), 48u);
  EXPECT_LT(fewer.hypotheses().size(), 48u);
  const BeaconHypothesis before = whole(all.hypotheses());
  const BeaconHypothesis after = whole(fewer.hypotheses());
  EXPECT_NEAR(after.weight, 1.0, 1e-12);
  EXPECT_LT((after.mean_m - before.mean_m).norm(), 1e-9);
  EXPECT_LT((after.covariance_m2 - before.covariance_m2).norm(), 1e-9);
}

// The second range is an outlier, so it does not change the eight hypotheses of the first range.
TEST(RangeOnlyFilter, MergesHypothesesWithinTheStatedDistance) {
  const auto left = [](double scale, double distance_m, double merge_sigma) {
    RangeOnlySpec spec = keeping_all(8);
    spec.calibration.range_scale = scale;
    spec.merge_distance_sigma = merge_sigma;
    spec.outlier_share = 0.5;
    RangeOnlyFilter filter(spec);
    filter.update({1.0, 2.0}, scale * distance_m);
    const std::vector<BeaconHypothesis> ring = filter.hypotheses();
    filter.update({1.0, 2.0}, 1e4);
    return std::pair(ring, filter.hypotheses().size());
  };
  const auto ring = left(1.0, 10.0, 0.0).first;
  const Eigen::Vector2d apart_m = ring[1].mean_m - ring[0].mean_m;
  const double apart_sigma = std::sqrt(apart_m.dot(ring[0].covariance_m2.inverse() * apart_m));
  EXPECT_EQ(left(1.0, 10.0, 0.999 * apart_sigma).second, 8u);
  EXPECT_LT(left(1.0, 10.0, 1.001 * apart_sigma).second, 8u);
  // A large scale makes hypotheses narrow. Hypotheses that ranges cannot distinguish are merged.
  const double chord = 2.0 * std::sin(kPi / 8.0);
  EXPECT_EQ(left(100.0, 0.251 / chord, 0.5).second, 8u);
  EXPECT_LT(left(100.0, 0.249 / chord, 0.5).second, 8u);
}

TEST(RangeOnlyFilter, DropsHypothesesBelowTheWeightLimit) {
  RangeOnlySpec spec = keeping_all(48);
  RangeOnlyFilter all(spec);
  spec.weight_min = 1e-3;
  RangeOnlyFilter fewer(spec);
  for (RangeOnlyFilter* filter : {&all, &fewer}) {
    filter->update({1.0, 2.0}, 9.0);
    filter->update({6.0, 3.0}, 8.0);
  }
  double kept = 0.0;
  std::size_t count = 0;
  for (const BeaconHypothesis& h : all.hypotheses()) {
    kept += h.weight >= 1e-3 ? h.weight : 0.0;
    count += h.weight >= 1e-3 ? 1 : 0;
  }
  ASSERT_EQ(fewer.hypotheses().size(), count);
  EXPECT_LT(count, 48u);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_NEAR(fewer.hypotheses()[i].weight, all.hypotheses()[i].weight / kept, 1e-12);
  }
}

// The filter restarts when less than half of the ranges in the window are explained, and then
// begins a new count.
TEST(RangeOnlyFilter, RestartsAfterAWindowOfUnexplainedRanges) {
  RangeOnlySpec spec;
  spec.restart_window = 4;
  RangeOnlyFilter filter(spec);
  const Eigen::Vector2d robot_m(1.0, 2.0);
  const auto update_with = [&](const std::vector<double>& ranges_m, std::int64_t restarts) {
    for (const double range_m : ranges_m) {
      EXPECT_EQ(filter.restarts(), 0);
      EXPECT_GT(filter.best().weight, 0.0);
      filter.update(robot_m, range_m);
    }
    EXPECT_EQ(filter.restarts(), restarts);
  };
  filter.update(robot_m, 10.0);
  update_with({10.0, 1e4, 10.0, 10.0}, 0);
  update_with({1e4, 10.0, 10.0, 10.0}, 0);
  update_with({1e4, 10.0, 1e4, 10.0}, 1);  // below half: no range is certain to be an inlier
  EXPECT_TRUE(filter.hypotheses().empty());
  EXPECT_EQ(filter.best().weight, 0.0);
  EXPECT_EQ(filter.best().mean_m, Eigen::Vector2d::Zero());
  filter.update(robot_m, 7.0);
  EXPECT_NEAR((filter.best().mean_m - robot_m).norm(), 7.0, 1e-9);
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(filter.restarts(), 1);
    filter.update(robot_m, 1e4);
  }
  EXPECT_EQ(filter.restarts(), 2) << "a second restart";
}

TEST(RangeOnlyFilter, RestartsOnAnUnexplainedRangeWithoutOutliers) {
  RangeOnlySpec spec;
  spec.outlier_share = 0.0;
  RangeOnlyFilter filter(spec);
  filter.update({0.0, 0.0}, 10.0);
  filter.update({1.0, 0.0}, 10.0);
  EXPECT_EQ(filter.restarts(), 0);
  filter.update({0.0, 0.0}, 1e4);
  EXPECT_EQ(filter.restarts(), 1);
  EXPECT_TRUE(filter.hypotheses().empty());
  // Only hypotheses that explain no range are dropped.
  RangeOnlyFilter some(spec);
  some.update({0.0, 0.0}, 1e3);
  some.update({1e3, 0.0}, 1e3);
  EXPECT_EQ(some.restarts(), 0);
  EXPECT_LT(some.hypotheses().size(), 40u);
  EXPECT_NEAR(whole(some.hypotheses()).weight, 1.0, 1e-12);
}

TEST(RangeOnlyFilter, RefusesEachInvalidSpec) {
  const auto is_refused = [](auto change) {
    RangeOnlySpec spec;
    change(spec);
    try {
      RangeOnlyFilter filter(spec);
    } catch (const UsageError&) {
      return true;
    }
    return false;
  };
  using Spec = RangeOnlySpec;
  EXPECT_TRUE(is_refused([](Spec& spec) { spec.hypotheses = 7; }));
  EXPECT_FALSE(is_refused([](Spec& spec) { spec.hypotheses = 8; }));
  EXPECT_TRUE(is_refused([](Spec& spec) { spec.calibration.range_scale = 0.0; }));
  EXPECT_TRUE(is_refused([](Spec& spec) { spec.range_sigma_m = 0.0; }));
  EXPECT_TRUE(is_refused([](Spec& spec) { spec.outlier_share = -0.01; }));
  EXPECT_FALSE(is_refused([](Spec& spec) { spec.outlier_share = 0.0; }));
  EXPECT_FALSE(is_refused([](Spec& spec) { spec.outlier_share = 0.99; }));
  EXPECT_TRUE(is_refused([](Spec& spec) { spec.outlier_share = 1.0; }));
  EXPECT_TRUE(is_refused([](Spec& spec) { spec.outlier_span_m = 0.0; }));
  EXPECT_TRUE(is_refused([](Spec& spec) { spec.restart_window = 0; }));
  EXPECT_FALSE(is_refused([](Spec& spec) { spec.restart_window = 1; }));
}

TEST(RangeOnlyFilter, RefusesRangesWithoutAPositiveFiniteDistance) {
  RangeOnlySpec spec;
  spec.calibration = {2.0, 1.5};
  RangeOnlyFilter filter(spec);
  filter.update({0.0, 0.0}, 1.5);
  filter.update({0.0, std::numeric_limits<double>::infinity()}, 5.0);
  filter.update({0.0, 0.0}, std::numeric_limits<double>::infinity());
  EXPECT_EQ(filter.refused(), 3);
  EXPECT_TRUE(filter.hypotheses().empty());
  filter.update({0.0, 0.0}, 1.6);
  EXPECT_EQ(filter.refused(), 3);
  EXPECT_FALSE(filter.hypotheses().empty());
}

TEST(RangeOnlyFilter, FindsTheBeaconsOfThePlazaRecording) {
  const std::string folder = VANTAGE_DATA_DIR "/plaza1/";
  const auto poses = read_csv(folder + "groundtruth.csv");
  const auto ranges = read_csv(folder + "ranges.csv");
  const auto beacons = read_csv(folder + "beacons.csv");
  if (poses.empty() || ranges.empty() || beacons.empty()) {
    GTEST_SKIP() << "no data in " << folder;
  }
  RangeOnlySpec spec;
  spec.calibration.range_scale = 1.069;  // the radios' ranges are 6.9 % too long
  spec.range_sigma_m = 0.6;              // m; a batch fit has 0.54 m rms
  std::map<int, RangeOnlyFilter> filters;
  std::size_t p = 0;
  for (const auto& row : ranges) {
    while (p + 2 < poses.size() && poses[p + 1][0] <= row[0]) {
      ++p;
    }
    const double share = (row[0] - poses[p][0]) / (poses[p + 1][0] - poses[p][0]);
    if (share < 0.0 || share > 1.0) {
      continue;
    }
    const Eigen::Vector2d before_m(poses[p][1], poses[p][2]);
    const Eigen::Vector2d after_m(poses[p + 1][1], poses[p + 1][2]);
    filters.try_emplace(static_cast<int>(row[1]), spec)
        .first->second.update(before_m + share * (after_m - before_m), row[2]);
  }
  ASSERT_EQ(filters.size(), beacons.size());
  for (const auto& beacon : beacons) {
    const int id = static_cast<int>(beacon[0]);
    const RangeOnlyFilter& filter = filters.at(id);
    const double error_m = (filter.best().mean_m - Eigen::Vector2d(beacon[1], beacon[2])).norm();
    std::cout << "beacon " << id << ": " << error_m << " m from its survey, "
              << filter.hypotheses().size() << " hypothesis left, " << filter.restarts()
              << " restarts\n";
    EXPECT_LT(error_m, 0.30);
    EXPECT_EQ(filter.hypotheses().size(), 1u);
  }
}

}  // namespace
}  // namespace vantage::estimator
