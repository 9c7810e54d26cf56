#include "estimator/range_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/index.hpp"

namespace vantage::estimator {
namespace {

constexpr int kPlaces = 400;

Eigen::Vector2d on_circle_m(int k) {
  const double angle_rad = 2.0 * kPi * k / kPlaces;
  return 15.0 * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
}

// Three beacons whose ranges are as noisy as it is said of each, and the same counted from the
// last.
TEST(FitAt, SaysOfEachBeaconTheSameWhateverItsNumber) {
  constexpr int kBeacons = 3;
  const RangeState state{{1.0, 0.0},
                         {{25.0, 5.0}, {-10.0, 20.0}, {3.0, -18.0}},
                         {{0.1, 0.05}, {1.0, 0.2}, {0.3, 0.1}}};
  RangeState renamed = state;
  std::reverse(renamed.places_m.begin(), renamed.places_m.end());
  std::reverse(renamed.noise.begin(), renamed.noise.end());
  std::mt19937_64 rng(3);
  std::normal_distribution<double> noise;
  std::vector<TakenRange> ranges;
  for (int k = 0; k < kPlaces; ++k) {
    const int b = k % kBeacons;
    const double distance_m = (state.places_m[index(b)] - on_circle_m(k)).norm();
    ranges.push_back({on_circle_m(k), distance_m + state.noise[index(b)].width_m * noise(rng), b});
  }
  const RangeFit fit = fit_at({ranges, 30.0, {}, {}}, state);
  for (TakenRange& range : ranges) {
    range.beacon = kBeacons - 1 - range.beacon;
  }
  const RangeFit other = fit_at({ranges, 30.0, {}, {}}, renamed);
  for (std::size_t b = 0; b < kBeacons; ++b) {
    const FittedBeacon& same = other.beacons[kBeacons - 1 - b];
    const CalibratedCovariance& joint = fit.beacons[b].joint;
    EXPECT_GT(joint(2, 2), 0.0);
    EXPECT_LT((same.joint - joint).norm(), 1e-9 * joint.norm()) << b;
    EXPECT_NEAR(same.range_sigma_m, fit.beacons[b].range_sigma_m, 1e-12);
  }
}

// Ten times round, and at each place the error is the same as before: of ten ranges one counts,
// however wide the noise is said to be.
TEST(FitAt, CountsErrorsThatAPlaceRepeatsOnceWhateverTheirUnit) {
  std::mt19937_64 rng(4);
  std::normal_distribution<double> noise(0.0, 0.3);
  std::vector<double> errors_m(kPlaces);
  for (double& error_m : errors_m) {
    error_m = noise(rng);
  }
  const Eigen::Vector2d beacon_m(25.0, 5.0);
  std::vector<TakenRange> ranges;
  for (int k = 0; k < 10 * kPlaces; ++k) {
    const Eigen::Vector2d robot_m = on_circle_m(k);
    ranges.push_back({robot_m, (beacon_m - robot_m).norm() + errors_m[index(k % kPlaces)], 0});
  }
  const auto correlation = [&](double width_m) {
    const RangeState state{{1.0, 0.0}, {beacon_m}, {{width_m, 0.0}}};
    return fit_at({ranges, 30.0, {}, {}}, state).correlation;
  };
  EXPECT_NEAR(correlation(3.0), 10.0, 2.5);
  EXPECT_NEAR(correlation(6.0), correlation(3.0), 0.1);
}

}  // namespace
}  // namespace vantage::estimator
