#include "estimator/range_only.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <random>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "test/estimator/csv.hpp"

namespace vantage::estimator {
namespace {

using test::read_csv;

TEST(RangeOnlyFilter, PutsTheFirstRangeOnARing) {
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
  for (int k = 0; k <= 100; ++k) {  // along the x axis: y and −y explain it equally well
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

// A sensor that says so much too much, and knows it, is no other sensor.
TEST(RangeOnlyFilter, FindsWithABiasWhatItFindsWithout) {
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

TEST(RangeOnlyFilter, StartsOverWhenTheFirstRangeWasAnOutlier) {
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

TEST(RangeOnlyFilter, RefusesWhatIsNoRange) {
  RangeOnlyFilter filter({});
  filter.update({0.0, 0.0}, std::numeric_limits<double>::quiet_NaN());
  filter.update({0.0, 0.0}, -1.0);
  EXPECT_EQ(filter.refused(), 2);
  RangeOnlySpec spec;
  spec.hypotheses = 3;
  EXPECT_THROW(RangeOnlyFilter{spec}, UsageError);
}

TEST(RangeOnlyFilter, FindsTheRealBeaconsOfPlaza) {
  const std::string folder = VANTAGE_DATA_DIR "/plaza1/";
  const auto poses = read_csv(folder + "groundtruth.csv");
  const auto ranges = read_csv(folder + "ranges.csv");
  const auto beacons = read_csv(folder + "beacons.csv");
  if (poses.empty() || ranges.empty() || beacons.empty()) {
    GTEST_SKIP() << "no data in " << folder;
  }
  RangeOnlySpec spec;
  spec.calibration.range_scale = 1.069;  // the radios measure 6.9 % long
  spec.range_sigma_m = 0.6;              // about the residual of a batch fit, 0.54 m rms
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
