#include "estimator/range_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
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

/// Two beacons of unlike noise about a robot that goes round, and what is thought of them at first.
struct Drawn {
  std::vector<TakenRange> ranges;
  RangeState truth{{1.1, -0.4}, {{9.0, 4.0}, {-6.0, 7.0}}, {{0.2, 0.05}, {0.5, 0.1}}};
  RangeFitSpec spec;
  models::RangeCalibration prior{1.05, -0.1};
  [[nodiscard]] RangeProblem problem() const { return {ranges, 30.0, prior, spec}; }
};

/// Errors as they are said to be: Student's t of 5 degrees of freedom, some anywhere.
Drawn draw(unsigned seed, int count) {
  std::mt19937_64 rng(seed);
  std::student_t_distribution<double> t(5.0);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Drawn out;
  for (int k = 0; k < count; ++k) {
    const int b = k % 2;
    const RangeNoise& noise = out.truth.noise[index(b)];
    const double angle_rad = 2.0 * kPi * unit(rng);
    const double radius_m = 2.0 + 6.0 * unit(rng);
    const Eigen::Vector2d robot_m =
        radius_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
    const double honest_m =
        1.1 * (out.truth.places_m[index(b)] - robot_m).norm() - 0.4 + noise.width_m * t(rng);
    const bool is_outlier = unit(rng) < noise.outlier_share;
    out.ranges.push_back({robot_m, is_outlier ? 30.0 * unit(rng) : honest_m, b});
  }
  return out;
}

TEST(ResidualOf, IsWhatARangeSaysMoreThanIsExpected) {
  const RangeState state{{1.5, 0.25}, {{0.0, 0.0}, {4.0, 6.0}}, {}};
  EXPECT_NEAR(residual_m(state, {{1.0, 2.0}, 9.0, 1}), 9.0 - 1.5 * 5.0 - 0.25, 1e-12);
  EXPECT_NEAR(residual_m(state, {{3.0, 4.0}, 1.0, 0}), 1.0 - 1.5 * 5.0 - 0.25, 1e-12);
}

// The median of what is off, either way, times what makes it a normal distribution's σ.
TEST(GuessNoise, IsOfEachBeaconByTheMiddleOfItsResiduals) {
  RangeState state{{1.0, 0.5}, {{0.0, 0.0}, {10.0, 0.0}, {0.0, 9.0}, {5.0, 5.0}}, {}};
  std::vector<TakenRange> ranges;
  for (const double off_m : {-4.0, 0.1, -2.0, 3.0, 1.0}) {
    ranges.push_back({{0.0, 3.0}, 3.5 + off_m, 0});
    ranges.push_back({{6.0, 0.0}, 4.5 + 0.5 * off_m, 1});
    ranges.push_back({{0.0, 8.0}, 1.5 + 1e-4 * off_m, 2});
  }
  guess_noise({ranges, 30.0, {}, {}}, state);
  ASSERT_EQ(state.noise.size(), 4U);
  EXPECT_NEAR(state.noise[0].width_m, 1.4826 * 2.0, 1e-9);
  EXPECT_NEAR(state.noise[1].width_m, 1.4826 * 1.0, 1e-9);
  EXPECT_EQ(state.noise[2].width_m, 0.01) << "no sensor is better than that";
  EXPECT_EQ(state.noise[3].width_m, RangeNoise{}.width_m) << "nothing is known of it";
  EXPECT_EQ(state.noise[0].outlier_share, RangeNoise{}.outlier_share);
}

TEST(LogPosterior, IsTheSumOfWhatEachRangeAndThePriorSay) {
  const Drawn drawn = draw(1, 40);
  double expected = -0.5 * (std::pow(0.05 / drawn.spec.range_scale_sigma, 2) +
                            std::pow(0.3 / drawn.spec.range_bias_sigma_m, 2));
  for (const TakenRange& range : drawn.ranges) {
    const RangeNoise& noise = drawn.truth.noise[index(range.beacon)];
    expected += verdict_of(residual_m(drawn.truth, range), noise, 30.0).nats;
  }
  EXPECT_NEAR(log_posterior(drawn.problem(), drawn.truth), expected, 1e-9);
}

// Whichever way one goes from there, and with a prior that matters: of scale and bias, too.
TEST(Refine, EndsWhereNothingNearIsLikelier) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Drawn drawn = draw(seed, 60);
    drawn.spec = {0.03, 0.2};
    RangeState state = drawn.truth;
    state.calibration = {0.95, 0.3};
    for (Eigen::Vector2d& place_m : state.places_m) {
      place_m += Eigen::Vector2d(0.8, -0.7);
    }
    guess_noise(drawn.problem(), state);
    const double top = refine(drawn.problem(), state, 200);
    EXPECT_NEAR(top, log_posterior(drawn.problem(), state), 1e-9);
    for (const double step : {-0.02, 0.02}) {
      const auto falls = [&](auto move) {
        RangeState beside = state;
        move(beside);
        EXPECT_LT(log_posterior(drawn.problem(), beside), top) << seed;
      };
      falls([&](RangeState& s) { s.calibration.range_scale += 0.1 * step; });
      falls([&](RangeState& s) { s.calibration.range_bias_m += step; });
      for (const std::size_t b : {0U, 1U}) {
        falls([&](RangeState& s) { s.places_m[b].x() += step; });
        falls([&](RangeState& s) { s.places_m[b].y() += step; });
      }
    }
    for (std::size_t b = 0; b < 2; ++b) {
      EXPECT_LT((state.places_m[b] - drawn.truth.places_m[b]).norm(), 0.7) << seed;
    }
  }
}

// Each is as wide, and as often wrong, as it was made; of few ranges more like the other.
TEST(Refine, KnowsTheNoiseOfEachBeacon) {
  Drawn drawn = draw(3, 4000);
  RangeState state = drawn.truth;
  guess_noise(drawn.problem(), state);
  refine(drawn.problem(), state, 200);
  for (std::size_t b = 0; b < 2; ++b) {
    const RangeNoise& right = drawn.truth.noise[b];
    EXPECT_NEAR(state.noise[b].width_m, right.width_m, 0.06 * right.width_m);
    EXPECT_NEAR(state.noise[b].outlier_share, right.outlier_share, 0.02);
  }
  // A beacon without an outlier, or with hardly anything else.
  for (TakenRange& range : drawn.ranges) {
    const double honest_m = residual_m(drawn.truth, range);
    if (range.beacon == 0 && std::abs(honest_m) > 0.5) {
      range.range_m -= honest_m;
    }
    if (range.beacon == 1 && (range.robot_m.x() < 4.0)) {
      range.range_m = 30.0 * std::abs(std::sin(1e3 * range.robot_m.y()));
    }
  }
  refine(drawn.problem(), state, 200);
  EXPECT_LT(state.noise[0].outlier_share, 0.01);
  EXPECT_GE(state.noise[0].outlier_share, 1e-3);
  EXPECT_LE(state.noise[1].outlier_share, 0.7);
}

// Truths and ranges drawn from what is thought of them: errors are as large as is said, of
// calibration and places together.
TEST(FitAt, KnowsHowWrongItIs) {
  constexpr int kFits = 250;
  double nees[2] = {0.0, 0.0};
  double of_calibration = 0.0;
  double outliers[2] = {0.0, 0.0};
  for (unsigned seed = 1; seed <= kFits; ++seed) {
    const Drawn drawn = draw(seed, 120);
    RangeState state = drawn.truth;
    guess_noise(drawn.problem(), state);
    refine(drawn.problem(), state, 60);
    const RangeFit fit = fit_at(drawn.problem(), state);
    EXPECT_EQ(fit.calibration.range_scale, state.calibration.range_scale);
    EXPECT_NEAR(fit.range_scale_sigma, std::sqrt(fit.beacons[0].joint(0, 0)), 1e-12);
    EXPECT_NEAR(fit.range_bias_sigma_m, std::sqrt(fit.beacons[1].joint(1, 1)), 1e-12);
    for (std::size_t b = 0; b < 2; ++b) {
      const FittedBeacon& beacon = fit.beacons[b];
      EXPECT_LT((beacon.joint - beacon.joint.transpose()).norm(), 1e-9 * beacon.joint.norm());
      Eigen::Vector4d off;
      off << fit.calibration.range_scale - 1.1, fit.calibration.range_bias_m + 0.4,
          beacon.position_m - drawn.truth.places_m[b];
      nees[b] += off.dot(Eigen::Matrix4d(beacon.joint).llt().solve(off)) / kFits;
      outliers[b] += beacon.outlier_share / kFits;
    }
    of_calibration +=
        std::pow((fit.calibration.range_scale - 1.1) / fit.range_scale_sigma, 2) / kFits;
  }
  // χ² of 4 and of 1: the mean of 250 is known to 0.18 and 0.09; the prior is a little off.
  for (std::size_t b = 0; b < 2; ++b) {
    EXPECT_NEAR(nees[b], 4.0, 0.7) << b;
  }
  EXPECT_NEAR(of_calibration, 1.0, 0.3);
  EXPECT_NEAR(outliers[0], 0.05, 0.03);
  EXPECT_NEAR(outliers[1], 0.1, 0.03);
}

// A millimetre is no other length: what is said of ranges in it is the same.
TEST(FitAt, IsTheSameInAnotherUnit) {
  constexpr double kUnits = 1000.0;
  Drawn drawn = draw(7, 200);
  const RangeFit in_m = fit_at(drawn.problem(), drawn.truth);
  Drawn other = drawn;
  for (TakenRange& range : other.ranges) {
    range.range_m *= kUnits;
    range.robot_m *= kUnits;
  }
  other.truth.calibration.range_bias_m *= kUnits;
  other.prior.range_bias_m *= kUnits;
  other.spec.range_bias_sigma_m *= kUnits;
  for (std::size_t b = 0; b < 2; ++b) {
    other.truth.places_m[b] *= kUnits;
    other.truth.noise[b].width_m *= kUnits;
  }
  const RangeFit in_mm =
      fit_at({other.ranges, 30.0 * kUnits, other.prior, other.spec}, other.truth);
  EXPECT_NEAR(in_mm.correlation, in_m.correlation, 1e-9);
  EXPECT_NEAR(in_mm.range_scale_sigma, in_m.range_scale_sigma, 1e-4 * in_m.range_scale_sigma);
  EXPECT_NEAR(in_mm.range_bias_sigma_m, kUnits * in_m.range_bias_sigma_m,
              0.1 * in_m.range_bias_sigma_m);
  const Eigen::Vector4d units(1.0, kUnits, kUnits, kUnits);
  for (std::size_t b = 0; b < 2; ++b) {
    const Eigen::Matrix4d joint = units.asDiagonal() * in_m.beacons[b].joint * units.asDiagonal();
    const Eigen::Matrix4d off = joint - in_mm.beacons[b].joint;
    EXPECT_LT((units.cwiseInverse().asDiagonal() * off * units.cwiseInverse().asDiagonal()).norm(),
              1e-3 * in_m.beacons[b].joint.norm());
    EXPECT_NEAR(in_mm.beacons[b].range_sigma_m, kUnits * in_m.beacons[b].range_sigma_m, 1e-6);
    EXPECT_EQ(in_mm.beacons[b].position_m, other.truth.places_m[b]);
  }
}

}  // namespace
}  // namespace vantage::estimator
