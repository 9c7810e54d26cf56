#include "estimator/ranges/range_fit.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/check.hpp"
#include "core/index.hpp"
#include "estimator/ranges/range_refinement.hpp"
#include "test/estimator/ranges/range_scene.hpp"

namespace vantage::estimator {
namespace {

TEST(ResidualDensity, HasTheDerivativesOfItsDensity) {
  const RangeNoise noise{0.4, 0.15};
  constexpr double kSpan_m = 50.0;
  constexpr double kStep_m = 1e-5;
  for (const double r : {-7.0, -1.5, -0.3, 0.0, 0.2, 1.1, 3.0}) {
    const ResidualDensity at = residual_density(r, noise, kSpan_m);
    const ResidualDensity below = residual_density(r - kStep_m, noise, kSpan_m);
    const ResidualDensity above = residual_density(r + kStep_m, noise, kSpan_m);
    EXPECT_NEAR(at.score, -(above.nats - below.nats) / (2.0 * kStep_m), 1e-6) << r;
    EXPECT_NEAR(at.slope, (above.score - below.score) / (2.0 * kStep_m), 1e-6) << r;
    EXPECT_NEAR(at.weight * r, at.score, 1e-12) << r;
  }
  EXPECT_GT(residual_density(0.0, noise, kSpan_m).inlier_probability, 0.99);
  EXPECT_LT(residual_density(20.0, noise, kSpan_m).inlier_probability, 0.01);
}

TEST(ResidualDensity, IntegratesToOne) {
  const RangeNoise noise{0.4, 0.15};
  double sum = 0.0;
  constexpr double kStep_m = 0.01;
  for (double r = -25.0; r < 25.0; r += kStep_m) {
    sum += kStep_m * std::exp(residual_density(r, noise, 50.0).nats);
  }
  EXPECT_NEAR(sum, 1.0, 1e-3);
}

TEST(FitRanges, IsExactForNoiselessRanges) {
  const test::RangeSceneSpec spec{.range_sigma_m = 1e-3, .outlier_share_max = 0.0};
  const test::RangeScene scene = test::draw_range_scene(3, spec);
  const RangeFit fit = fit_ranges(scene.ranges, static_cast<int>(scene.beacons_m.size()));
  EXPECT_NEAR(fit.calibration.range_scale, scene.calibration.range_scale, 1e-3);
  EXPECT_NEAR(fit.calibration.range_bias_m, scene.calibration.range_bias_m, 0.01);
  for (std::size_t b = 0; b < scene.beacons_m.size(); ++b) {
    EXPECT_LT((fit.beacons[b].position_m - scene.beacons_m[b]).norm(), 0.02);
    EXPECT_GT(fit.beacons[b].probability, 0.99);
    EXPECT_LT(fit.beacons[b].outlier_share, 0.01);
  }
}

TEST(FitRanges, IsDeterministic) {
  const test::RangeScene scene = test::draw_range_scene(4, {});
  const int beacons = static_cast<int>(scene.beacons_m.size());
  const RangeFit a = fit_ranges(scene.ranges, beacons);
  const RangeFit b = fit_ranges(scene.ranges, beacons);
  EXPECT_EQ(a.calibration.range_scale, b.calibration.range_scale);
  EXPECT_EQ(a.beacons.back().position_m, b.beacons.back().position_m);
}

TEST(FitRanges, ReportsAmbiguityOfAStraightPath) {
  std::mt19937_64 rng(1);
  std::normal_distribution<double> noise(0.0, 0.1);
  const Eigen::Vector2d beacon_m(12.0, 7.0);
  std::vector<TakenRange> ranges;
  for (int k = 0; k < 300; ++k) {
    const Eigen::Vector2d robot_m(0.1 * k, 0.0);
    ranges.push_back({robot_m, 1.1 * (beacon_m - robot_m).norm() + noise(rng), 0});
  }
  const FittedBeacon beacon = fit_ranges(ranges, 1).beacons.front();
  EXPECT_NEAR(beacon.probability, 0.5, 0.1);
  ASSERT_TRUE(beacon.other.has_value());
  const double side = beacon.position_m.y() > 0.0 ? 1.0 : -1.0;
  EXPECT_LT((beacon.position_m - Eigen::Vector2d(12.0, 7.0 * side)).norm(), 0.5);
  EXPECT_LT((*beacon.other - Eigen::Vector2d(12.0, -7.0 * side)).norm(), 0.5);
}

// On a straight path, half of the ranges fit one position and half another. Each position is as
// likely as its mirror image, and the mirror image is likelier than the other two candidates.
TEST(FitRanges, ReportsTheLikeliestAlternativePosition) {
  const Eigen::Vector2d places_m[] = {{12.0, 7.0}, {20.0, -4.0}};
  for (unsigned seed = 1; seed <= 8; ++seed) {
    std::mt19937_64 rng(seed);
    std::normal_distribution<double> noise(0.0, 0.3);
    std::vector<TakenRange> ranges;
    for (int k = 0; k < 60; ++k) {
      const Eigen::Vector2d robot_m(0.5 * k, 0.0);
      ranges.push_back({robot_m, (places_m[k % 2] - robot_m).norm() + noise(rng), 0});
    }
    const FittedBeacon beacon = fit_ranges(ranges, 1).beacons.front();
    ASSERT_TRUE(beacon.other.has_value()) << seed;
    EXPECT_NEAR(beacon.other->x(), beacon.position_m.x(), 0.1) << seed;
    EXPECT_NEAR(beacon.other->y(), -beacon.position_m.y(), 0.1) << seed;
  }
}

// If successive errors have correlation ρ, (1 + ρ)/(1 − ρ) of them count as one.
TEST(FitRanges, CountsCorrelatedErrorsOnce) {
  const auto correlation = [](double of_successive) {
    const test::RangeSceneSpec spec{
        .ranges_of_beacon = 2000, .outlier_share_max = 0.0, .correlation = of_successive};
    const test::RangeScene scene = test::draw_range_scene(9, spec);
    return fit_ranges(scene.ranges, static_cast<int>(scene.beacons_m.size())).correlation;
  };
  EXPECT_NEAR(correlation(0.0), 1.0, 0.15);
  EXPECT_NEAR(correlation(0.5), 3.0, 0.6);
  EXPECT_NEAR(correlation(0.8), 9.0, 2.5);
}

// Ten laps have the same error at the same position, and errors are correlated over 0.25 m only.
// Ten laps still count as one.
TEST(FitRanges, CountsRepeatedErrorsOfAPositionOnce) {
  const std::vector<TakenRange> ranges = test::repeated_ranges(2);
  const RangeFit fit = fit_ranges(ranges, 1);
  EXPECT_NEAR(fit.correlation, 10.0, 2.5);
}

TEST(FitRanges, ReportsConsistentInnovationsForItsOwnModel) {
  const test::RangeScene scene = test::draw_range_scene(11, {.ranges_of_beacon = 500});
  const int beacons = static_cast<int>(scene.beacons_m.size());
  const auto half = static_cast<std::ptrdiff_t>(scene.ranges.size() / 2);
  const std::vector<TakenRange> first(scene.ranges.begin(), scene.ranges.begin() + half);
  const std::vector<TakenRange> second(scene.ranges.begin() + half, scene.ranges.end());
  const InnovationScore score = judge(fit_ranges(first, beacons), second);
  EXPECT_EQ(score.inliers + score.outliers, static_cast<int>(second.size()));
  EXPECT_NEAR(score.nees, 1.0, 0.2);
}

TEST(FitRanges, RefusesInvalidRecordings) {
  const test::RangeScene scene = test::draw_range_scene(1, {});
  const int beacons = static_cast<int>(scene.beacons_m.size());
  EXPECT_THROW(fit_ranges({}, 1), UsageError);
  EXPECT_THROW(fit_ranges({}, 0), UsageError);
  EXPECT_THROW(fit_ranges(scene.ranges, beacons + 1), UsageError);
  EXPECT_THROW(fit_ranges(scene.ranges, beacons - 1), UsageError);
  std::vector<TakenRange> broken = scene.ranges;
  broken[5].range_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(fit_ranges(broken, beacons), UsageError);
}

/// Returns ranges to two beacons, with the change that a test case makes.
std::vector<TakenRange> ranges_of(const std::function<TakenRange(int)>& range) {
  std::vector<TakenRange> out;
  for (int k = 0; k < 40; ++k) {
    out.push_back(range(k));
    out.back().beacon = k % 2;
  }
  return out;
}

// The ranges include numbers with overflowing squares and positions that cannot distinguish the
// beacons.
TEST(FitRanges, EndsWithAFitOrARefusalForAnyRanges) {
  const auto at = [](double x_m, double range_m) {
    return TakenRange{Eigen::Vector2d(x_m, 0.5 * x_m), range_m, 0};
  };
  const std::vector<std::vector<TakenRange>> all = {
      ranges_of([&](int k) { return at(k, 1e308); }),
      ranges_of([&](int k) { return at(k, k % 7 == 0 ? 1e300 : 5.0); }),
      ranges_of([&](int k) { return at(k, -1e200); }),
      ranges_of([&](int k) { return at(k * 1e300, 5.0); }),
      ranges_of([&](int k) { return at(k % 9 == 0 ? 1e308 : k, 5.0); }),
      ranges_of([&](int k) { return at(k, 1e12 * k); }),
      ranges_of([&](int /*k*/) { return at(0.0, 0.0); }),
      ranges_of([&](int /*k*/) { return at(3.0, 5.0); }),
      ranges_of([&](int k) { return at(1e-300 * k, 1e-300); })};
  for (std::size_t i = 0; i < all.size(); ++i) {
    try {
      for (const FittedBeacon& beacon : fit_ranges(all[i], 2).beacons) {
        EXPECT_TRUE(beacon.position_m.allFinite()) << i;
      }
    } catch (const UsageError& refusal) {
      EXPECT_NE(std::string(refusal.what()).find("range"), std::string::npos) << i;
    }
  }
}

TEST(FitRanges, IsAccurateIfOneBeaconHasOnlyOutliers) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> anything(0.0, 80.0);
  test::RangeScene scene = test::draw_range_scene(6, {.outlier_share_max = 0.0});
  const int beacons = static_cast<int>(scene.beacons_m.size());
  for (int k = 0; k < 50; ++k) {
    scene.ranges.push_back({scene.ranges[index(10 * k)].robot_m, anything(rng), beacons});
  }
  const RangeFit fit = fit_ranges(scene.ranges, beacons + 1);
  EXPECT_NEAR(fit.calibration.range_scale, scene.calibration.range_scale, 0.05);
  for (std::size_t b = 0; b < scene.beacons_m.size(); ++b) {
    EXPECT_LT((fit.beacons[b].position_m - scene.beacons_m[b]).norm(), 1.5);
  }
  EXPECT_TRUE(fit.beacons.back().joint.allFinite());
}

// All numbers of the fit are different. Each range is compared with its prediction.
TEST(Judge, ScoresRangesWithinFourSigma) {
  RangeFit fit;
  fit.calibration = {1.1, 0.5};
  fit.beacons.resize(2);
  fit.beacons[0].position_m = {-50.0, 70.0};
  FittedBeacon& beacon = fit.beacons[1];
  beacon.position_m = {4.0, 2.0};
  beacon.range_sigma_m = 0.3;
  Eigen::Matrix4d root;
  root << 0.02, 0.0, 0.0, 0.0, -0.1, 0.3, 0.0, 0.0, 0.05, 0.1, 0.2, 0.0, -0.07, 0.02, 0.1, 0.25;
  beacon.joint = root * root.transpose();
  const Eigen::Vector2d robot_m(1.0, -2.0);  // 5 m away, direction (0.6, 0.8)
  const Eigen::Vector4d slopes(5.0, 1.0, 1.1 * 0.6, 1.1 * 0.8);
  const double sigma_m = std::hypot(0.3, (root.transpose() * slopes).norm());
  const double expected_m = 1.1 * 5.0 + 0.5;
  const auto score = [&](const std::vector<double>& off_sigma) {
    std::vector<TakenRange> ranges;
    for (const double off : off_sigma) {
      ranges.push_back({robot_m, expected_m + off * sigma_m, 1});
    }
    return judge(fit, ranges);
  };
  for (const double side : {-1.0, 1.0}) {
    EXPECT_EQ(score({side * 3.999}).inliers, 1);
    EXPECT_EQ(score({side * 3.999}).outliers, 0);
    EXPECT_NEAR(score({side * 3.999}).nees, 3.999 * 3.999, 1e-9);
    EXPECT_EQ(score({side * 4.001}).inliers, 0);
    EXPECT_EQ(score({side * 4.001}).outliers, 1);
    EXPECT_EQ(score({side * 4.001}).nees, 0.0);
  }
  const InnovationScore several = score({2.0, -9.0, 1.0, 9.0, 5.0, -0.5});
  EXPECT_EQ(several.inliers, 3);
  EXPECT_EQ(several.outliers, 3);
  EXPECT_NEAR(several.nees, (4.0 + 1.0 + 0.25) / 3.0, 1e-9);
  EXPECT_EQ(score({}).nees, 0.0);
  // At the beacon itself the direction is undefined, but the prediction is finite.
  const TakenRange there{beacon.position_m, 0.5, 1};
  EXPECT_EQ(judge(fit, {&there, 1}).inliers, 1);
  EXPECT_LT(judge(fit, {&there, 1}).nees, 1e-6);
}

// Half of the ranges are below zero.
TEST(FitRanges, FitsASensorWithNegativeRanges) {
  std::mt19937_64 rng(3);
  std::normal_distribution<double> noise(0.0, 0.05);
  const Eigen::Vector2d beacons_m[] = {{3.0, 1.0}, {-2.0, 2.5}};
  std::vector<TakenRange> ranges;
  for (int k = 0; k < 240; ++k) {
    const Eigen::Vector2d robot_m(2.0 * std::cos(0.05 * k), 2.5 * std::sin(0.05 * k));
    ranges.push_back({robot_m, (beacons_m[k % 2] - robot_m).norm() - 2.0 + noise(rng), k % 2});
  }
  const RangeFit fit = fit_ranges(ranges, 2);
  EXPECT_NEAR(fit.calibration.range_bias_m, -2.0, 0.1);
  for (std::size_t b = 0; b < 2; ++b) {
    EXPECT_LT((fit.beacons[b].position_m - beacons_m[b]).norm(), 0.1);
    EXPECT_NEAR(fit.beacons[b].range_sigma_m, 0.05, 0.01);
    EXPECT_GT(fit.beacons[b].probability, 0.99);
    EXPECT_FALSE(fit.beacons[b].other.has_value());
  }
}

TEST(FitRanges, RequiresTheStatedMinimumOfRanges) {
  const test::RangeScene scene = test::draw_range_scene(3, {.ranges_of_beacon = 40});
  std::vector<TakenRange> ranges;
  for (const TakenRange& range : scene.ranges) {
    if (range.beacon == 0 && ranges.size() < index(kRangesOfBeaconMin)) {
      ranges.push_back(range);
    }
  }
  ASSERT_EQ(ranges.size(), 10U);
  EXPECT_EQ(fit_ranges(ranges, 1).beacons.size(), 1U);
  ranges.pop_back();
  EXPECT_THROW(fit_ranges(ranges, 1), UsageError);
  TakenRange broken = ranges.front();
  broken.robot_m.y() = std::numeric_limits<double>::infinity();
  ranges.resize(10, broken);
  EXPECT_THROW(fit_ranges(ranges, 1), UsageError);
  ranges.back() = ranges.front();
  ranges.back().beacon = -1;
  ranges.push_back(ranges.front());
  EXPECT_THROW(fit_ranges(ranges, 1), UsageError);
}

// The sensor reads 2 m too short and the beacon is nearer than 2 m, so no range is positive.
TEST(FitRanges, FitsABeaconWithNonPositiveRangesOnly) {
  std::mt19937_64 rng(8);
  std::normal_distribution<double> noise(0.0, 0.02);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Eigen::Vector2d beacon_m(0.4, -0.2);
  std::vector<TakenRange> ranges;
  while (ranges.size() < 200) {
    const Eigen::Vector2d robot_m(1.2 * unit(rng), 1.2 * unit(rng));
    const double range_m = (beacon_m - robot_m).norm() - 2.0 + noise(rng);
    if (range_m < -0.05) {
      ranges.push_back({robot_m, range_m, 0});
    }
  }
  const RangeFit fit = fit_ranges(ranges, 1);
  EXPECT_NEAR(fit.calibration.range_bias_m, -2.0, 0.05);
  EXPECT_NEAR(fit.calibration.range_scale, 1.0, 0.05);
  EXPECT_LT((fit.beacons[0].position_m - beacon_m).norm(), 0.03);
  EXPECT_NEAR(fit.beacons[0].range_sigma_m, 0.02, 0.004);
  EXPECT_LT(fit.beacons[0].outlier_share, 0.05);
}

// Along a nearly straight path a position is likelier than its mirror image. Repeating each range
// does not change the probability: two equal ranges count as one.
TEST(FitRanges, DuplicateRangesAddNoCertainty) {
  int cases = 0;
  for (const double bend_m : {0.05, 0.1, 0.15}) {
    std::mt19937_64 rng(4);
    std::normal_distribution<double> noise(0.0, 0.3);
    const Eigen::Vector2d beacon_m(12.0, 7.0);
    std::vector<TakenRange> once;
    std::vector<TakenRange> twice;
    for (int k = 0; k < 300; ++k) {
      const Eigen::Vector2d robot_m(0.1 * k, bend_m * std::sin(0.05 * k));
      once.push_back({robot_m, (beacon_m - robot_m).norm() + noise(rng), 0});
      twice.insert(twice.end(), 2, once.back());
    }
    const auto nats = [](const std::vector<TakenRange>& ranges) {
      const double probability = fit_ranges(ranges, 1).beacons.front().probability;
      return std::log(probability / (1.0 - probability));
    };
    const double of_once = nats(once);
    if (std::abs(of_once) > 0.5 && std::abs(of_once) < 20.0) {
      EXPECT_NEAR(nats(twice) / of_once, 1.0, 0.25) << bend_m;
      ++cases;
    }
  }
  EXPECT_GT(cases, 0);
}

}  // namespace
}  // namespace vantage::estimator
