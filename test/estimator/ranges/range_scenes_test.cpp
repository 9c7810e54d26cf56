#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/index.hpp"
#include "estimator/ranges/range_fit.hpp"
#include "test/estimator/ranges/range_scene.hpp"

// Simulated recordings: the errors of fit_ranges() agree with its covariances.

namespace vantage::estimator {
namespace {

/// Returns the number of scenes: VANTAGE_RANGE_SCENES, or 60 if it is not set.
unsigned scenes() {
  const char* const text = std::getenv("VANTAGE_RANGE_SCENES");
  return text == nullptr ? 60U : static_cast<unsigned>(std::stoul(text));
}

/// Mean squared errors, in units of the claimed variance, over scenes() scenes from `first_seed`
/// on.
struct Claims {
  double beacon_nees = 0.0;
  int beacons = 0;
  double scale_nees = 0.0;
  double bias_nees = 0.0;
  int scale_beyond_3_sigma = 0;
  double farthest_m = 0.0;
};

Claims claims_of(const test::RangeSceneSpec& spec, unsigned first_seed) {
  Claims out;
  for (unsigned seed = first_seed; seed < first_seed + scenes(); ++seed) {
    const test::RangeScene scene = test::draw_range_scene(seed, spec);
    const int beacons = static_cast<int>(scene.beacons_m.size());
    const RangeFit fit = fit_ranges(scene.ranges, beacons);
    for (int b = 0; b < beacons; ++b) {
      const FittedBeacon& beacon = fit.beacons[index(b)];
      const Eigen::Vector2d error_m = beacon.position_m - scene.beacons_m[index(b)];
      out.beacon_nees += error_m.dot(beacon.covariance_m2().inverse() * error_m);
      out.farthest_m = std::max(out.farthest_m, error_m.norm());
      ++out.beacons;
    }
    const double scale =
        (fit.calibration.range_scale - scene.calibration.range_scale) / fit.range_scale_sigma;
    const double bias =
        (fit.calibration.range_bias_m - scene.calibration.range_bias_m) / fit.range_bias_sigma_m;
    out.scale_nees += scale * scale / scenes();
    out.bias_nees += bias * bias / scenes();
    out.scale_beyond_3_sigma += std::abs(scale) > 3.0 ? 1 : 0;
  }
  out.beacon_nees /= out.beacons;
  std::cout << "beacons " << out.beacons << ", mean NEES " << out.beacon_nees << " of 2, scale "
            << out.scale_nees << ", bias " << out.bias_nees << " of 1, scale beyond 3 sigma "
            << out.scale_beyond_3_sigma << " of " << scenes() << ", farthest " << out.farthest_m
            << " m\n";
  return out;
}

/// Expects mean values within 3.3 standard errors, which chance exceeds once in a thousand. A mean
/// of n χ²_k values has variance 2k/n. Beacons of one scene share its bias, so a scene is one
/// sample.
void expect_claims_hold(const Claims& claims) {
  constexpr double kBand = 3.3;
  const double n = scenes();
  EXPECT_NEAR(claims.beacon_nees, 2.0, kBand * std::sqrt(4.0 / n));
  EXPECT_NEAR(claims.scale_nees, 1.0, kBand * std::sqrt(2.0 / n));
  EXPECT_NEAR(claims.bias_nees, 1.0, kBand * std::sqrt(2.0 / n));
  EXPECT_LE(claims.scale_beyond_3_sigma,
            2.0 + n / 100.0);  // expected 0.0027 n; a false failure is rarer than 1/1000
}

TEST(RandomRangeScenes, ErrorsMatchTheClaimedCovariance) {
  const Claims claims = claims_of({}, 5001);
  expect_claims_hold(claims);
  EXPECT_LT(claims.farthest_m, 6.0);  // m; no fit is the mirror image
}

TEST(RandomRangeScenes, ErrorsMatchTheClaimedCovarianceInARoom) {
  expect_claims_hold(claims_of({.half_side_m = 4.0, .range_sigma_m = 0.1}, 6001));
}

// Errors are correlated over ten ranges of a beacon. If the ranges were treated as independent, σ
// would be a third of the correct value.
TEST(RandomRangeScenes, ErrorsMatchTheClaimedCovarianceWithCorrelatedErrors) {
  expect_claims_hold(claims_of({.ranges_of_beacon = 400, .correlation = 0.8}, 7001));
}

}  // namespace
}  // namespace vantage::estimator
