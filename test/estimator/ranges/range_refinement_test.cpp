#include "estimator/ranges/range_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/index.hpp"
#include "test/estimator/ranges/range_scene.hpp"

namespace vantage::estimator {
namespace {

using test::kLapPositions;
using test::on_circle_m;

// Fits three beacons with the stated noise. The result must not depend on their order.
TEST(FitAt, IsIndependentOfBeaconNumbers) {
  constexpr int kBeacons = 3;
  const RangeState state{{1.0, 0.0},
                         {{25.0, 5.0}, {-10.0, 20.0}, {3.0, -18.0}},
                         {{0.1, 0.05}, {1.0, 0.2}, {0.3, 0.1}}};
  RangeState renamed = state;
  std::reverse(renamed.beacons_m.begin(), renamed.beacons_m.end());
  std::reverse(renamed.noise.begin(), renamed.noise.end());
  std::mt19937_64 rng(3);
  std::normal_distribution<double> noise;
  std::vector<TakenRange> ranges;
  for (int k = 0; k < kLapPositions; ++k) {
    const int b = k % kBeacons;
    const double distance_m = (state.beacons_m[index(b)] - on_circle_m(k)).norm();
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

// In ten laps, the same error occurs at the same position: ten ranges count as one, for any stated
// noise.
TEST(FitAt, CountsRepeatedErrorsOnceInAnyUnit) {
  const std::vector<TakenRange> ranges = test::repeated_ranges(4);
  const auto correlation = [&](double width_m) {
    const RangeState state{{1.0, 0.0}, {{25.0, 5.0}}, {{width_m, 0.0}}};
    return fit_at({ranges, 30.0, {}, {}}, state).correlation;
  };
  EXPECT_NEAR(correlation(3.0), 10.0, 2.5);
  EXPECT_NEAR(correlation(6.0), correlation(3.0), 0.1);
}

/// Two beacons of different noise around a moving robot, and the prior of the fit.
struct Drawn {
  std::vector<TakenRange> ranges;
  RangeState truth{{1.1, -0.4}, {{9.0, 4.0}, {-6.0, 7.0}}, {{0.2, 0.05}, {0.5, 0.1}}};
  RangeFitSpec spec;
  models::RangeCalibration prior{1.05, -0.1};
  [[nodiscard]] RangeProblem problem() const { return {ranges, 30.0, prior, spec}; }
};

/// Draws ranges with noise of the stated width: Student's t with 5 degrees of freedom, and some
/// uniform outliers.
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
        1.1 * (out.truth.beacons_m[index(b)] - robot_m).norm() - 0.4 + noise.width_m * t(rng);
    const bool is_outlier = unit(rng) < noise.outlier_share;
    out.ranges.push_back({robot_m, is_outlier ? 30.0 * unit(rng) : honest_m, b});
  }
  return out;
}

TEST(ResidualOf, IsTheRangeMinusItsExpectation) {
  const RangeState state{{1.5, 0.25}, {{0.0, 0.0}, {4.0, 6.0}}, {}};
  EXPECT_NEAR(residual_m(state, {{1.0, 2.0}, 9.0, 1}), 9.0 - 1.5 * 5.0 - 0.25, 1e-12);
  EXPECT_NEAR(residual_m(state, {{3.0, 4.0}, 1.0, 0}), 1.0 - 1.5 * 5.0 - 0.25, 1e-12);
}

// The noise is the median of the absolute residuals times 1.4826 (σ of a normal distribution).
TEST(GuessNoise, UsesTheMedianResidualPerBeacon) {
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
  EXPECT_EQ(state.noise[2].width_m, 0.01) << "lower limit of the noise";
  EXPECT_EQ(state.noise[3].width_m, RangeNoise{}.width_m) << "without data the default applies";
  EXPECT_EQ(state.noise[0].outlier_share, RangeNoise{}.outlier_share);
}

TEST(LogPosterior, SumsRangesAndPrior) {
  const Drawn drawn = draw(1, 40);
  double expected = -0.5 * (std::pow(0.05 / drawn.spec.range_scale_sigma, 2) +
                            std::pow(0.3 / drawn.spec.range_bias_sigma_m, 2));
  for (const TakenRange& range : drawn.ranges) {
    const RangeNoise& noise = drawn.truth.noise[index(range.beacon)];
    expected += residual_density(residual_m(drawn.truth, range), noise, 30.0).nats;
  }
  EXPECT_NEAR(log_posterior(drawn.problem(), drawn.truth), expected, 1e-9);
}

// A step in any direction lowers the posterior, with an informative prior of scale and bias.
TEST(Refine, EndsAtALocalMaximum) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Drawn drawn = draw(seed, 60);
    drawn.spec = {0.03, 0.2};
    RangeState state = drawn.truth;
    state.calibration = {0.95, 0.3};
    for (Eigen::Vector2d& position_m : state.beacons_m) {
      position_m += Eigen::Vector2d(0.8, -0.7);
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
        falls([&](RangeState& s) { s.beacons_m[b].x() += step; });
        falls([&](RangeState& s) { s.beacons_m[b].y() += step; });
      }
    }
    for (std::size_t b = 0; b < 2; ++b) {
      EXPECT_LT((state.beacons_m[b] - drawn.truth.beacons_m[b]).norm(), 0.7) << seed;
    }
  }
}

// The estimated width and outlier share of each beacon equal those of the simulation.
TEST(Refine, EstimatesTheNoisePerBeacon) {
  Drawn drawn = draw(3, 4000);
  RangeState state = drawn.truth;
  guess_noise(drawn.problem(), state);
  refine(drawn.problem(), state, 200);
  for (std::size_t b = 0; b < 2; ++b) {
    const RangeNoise& right = drawn.truth.noise[b];
    EXPECT_NEAR(state.noise[b].width_m, right.width_m, 0.06 * right.width_m);
    EXPECT_NEAR(state.noise[b].outlier_share, right.outlier_share, 0.02);
  }
  // One beacon has no outliers, the other almost only outliers.
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

// Truths are drawn from the prior and ranges from the noise model. The errors of positions and
// calibration agree with the reported covariance.
TEST(FitAt, IsConsistent) {
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
          beacon.position_m - drawn.truth.beacons_m[b];
      nees[b] += off.dot(Eigen::Matrix4d(beacon.joint).llt().solve(off)) / kFits;
      outliers[b] += beacon.outlier_share / kFits;
    }
    of_calibration +=
        std::pow((fit.calibration.range_scale - 1.1) / fit.range_scale_sigma, 2) / kFits;
  }
  // χ² with 4 and 1 degrees of freedom: the means of 250 values have σ 0.18 and 0.09. The prior
  // adds a small bias.
  for (std::size_t b = 0; b < 2; ++b) {
    EXPECT_NEAR(nees[b], 4.0, 0.7) << b;
  }
  EXPECT_NEAR(of_calibration, 1.0, 0.3);
  EXPECT_NEAR(outliers[0], 0.05, 0.03);
  EXPECT_NEAR(outliers[1], 0.1, 0.03);
}

// A fit in millimetres gives the same result as in metres.
TEST(FitAt, IsIndependentOfTheUnit) {
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
    other.truth.beacons_m[b] *= kUnits;
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
    EXPECT_EQ(in_mm.beacons[b].position_m, other.truth.beacons_m[b]);
  }
}

/// Returns the correlation that a fit finds for the errors of one beacon, each at its robot
/// position.
double correlation_of(const std::vector<Eigen::Vector2d>& robots_m,
                      const std::vector<double>& errors_m) {
  const Eigen::Vector2d beacon_m(250.0, 500.0);
  std::vector<TakenRange> ranges;
  for (std::size_t k = 0; k < errors_m.size(); ++k) {
    ranges.push_back({robots_m[k], (beacon_m - robots_m[k]).norm() + errors_m[k], 0});
  }
  return fit_at({ranges, 30.0, {}, {}}, {{1.0, 0.0}, {beacon_m}, {{5.0, 0.0}}}).correlation;
}

// The robot jumps between random positions, so errors are correlated in time only. If successive
// errors have correlation ρ, max(1, (1 + ρ)/(1 − ρ)) ranges count as one.
TEST(FitAt, CountsCorrelatedErrorsOnceAtAnyPosition) {
  for (const double of_successive : {-0.5, 0.0, 0.5, 0.7}) {
    std::mt19937_64 rng(5);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> place(-50.0, 50.0);
    std::vector<Eigen::Vector2d> robots_m;
    std::vector<double> errors_m;
    double error = normal(rng);
    for (int k = 0; k < 6000; ++k) {
      error = of_successive * error + std::sqrt(1.0 - of_successive * of_successive) * normal(rng);
      errors_m.push_back(0.3 * error);
      robots_m.emplace_back(place(rng), place(rng));
    }
    const double right = std::max(1.0, (1.0 + of_successive) / (1.0 - of_successive));
    EXPECT_NEAR(correlation_of(robots_m, errors_m), right, 0.1 * right) << of_successive;
  }
}

/// Returns 64 errors of ±0.3 m, one per position in a row. `more_alike` is the number of equal
/// neighbour pairs minus the number of unequal ones. Errors at a greater distance are not
/// positively correlated.
std::vector<double> errors_of_places(int more_alike, std::mt19937_64& rng) {
  constexpr int kRow = 64;
  const int changes = (kRow - 1 - more_alike) / 2;
  std::vector<double> errors_m(kRow);
  while (true) {
    std::vector<int> is_change(kRow - 1, 0);
    std::fill(is_change.begin(), is_change.begin() + changes, 1);
    std::shuffle(is_change.begin(), is_change.end(), rng);
    errors_m[0] = 0.3;
    for (std::size_t k = 1; k < kRow; ++k) {
      errors_m[k] = is_change[k - 1] == 1 ? -errors_m[k - 1] : errors_m[k - 1];
    }
    const auto alike = [&](std::size_t apart, bool is_round) {
      double sum = 0.0;
      for (std::size_t k = 0; k < kRow; ++k) {
        sum += is_round || k + apart < kRow ? errors_m[k] * errors_m[(k + apart) % kRow] : 0.0;
      }
      return sum;
    };
    if (alike(2, false) <= 0.0 && alike(2, true) + alike(3, true) <= 0.0) {
      return errors_m;
    }
  }
}

// The row is repeated n times, but each error counts once. The neighbour correlation of 64
// independent errors has σ 1/8 for any number of repetitions. A correlation below 2/8 counts as
// chance.
TEST(FitAt, ChanceLevelIsIndependentOfRepetitions) {
  std::mt19937_64 rng(6);
  for (const int times : {2, 6, 12}) {
    for (const int more_alike : {-11, 1, 15, 17, 25}) {  // threshold: 2/8 of 63 pairs
      const std::vector<double> of_row_m = errors_of_places(more_alike, rng);
      std::vector<Eigen::Vector2d> robots_m;
      std::vector<double> errors_m;
      for (int time = 0; time < times; ++time) {
        for (std::size_t k = 0; k < of_row_m.size(); ++k) {
          robots_m.emplace_back(static_cast<double>(k), 0.0);
          errors_m.push_back(of_row_m[k]);
        }
      }
      const double neighbours = more_alike > 16 ? 2.0 * more_alike / 64.0 : 0.0;
      EXPECT_NEAR(correlation_of(robots_m, errors_m), times * (1.0 + neighbours), 1e-6)
          << times << " " << more_alike;
    }
  }
}

// Errors of equal size and alternating sign give the covariance C = s (ψ/ψ′)² (Σ J Jᵀ)⁻¹. With N
// ranges per beacon, s = N/(N − 2 − 2/beacons) corrects for the fitted parameters; s = N where one
// degree of freedom or none is left.
TEST(FitAt, CorrectsForFittedResiduals) {
  constexpr double kWidth_m = 0.4;
  constexpr double kError_m = 0.25;
  const ResidualDensity density = residual_density(kError_m, {kWidth_m, 0.0}, 30.0);
  for (const int beacons : {1, 2}) {
    for (const int count : {4, 5, 6, 7, 9, 30}) {
      RangeState state{{1.2, 0.3}, {{9.0, 4.0}, {-6.0, 7.0}}, {{kWidth_m, 0.0}, {kWidth_m, 0.0}}};
      state.beacons_m.resize(index(beacons));
      state.noise.resize(index(beacons));
      std::vector<TakenRange> ranges;
      const Eigen::Index size = 2 + 2 * beacons;
      Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
      for (int k = 0; k < count; ++k) {
        for (int b = 0; b < beacons; ++b) {
          const Eigen::Vector2d robot_m(-5.0 + 17.0 * std::sin(1.0 + k), 13.0 * std::cos(2.5 * k));
          const Eigen::Vector2d away_m = state.beacons_m[index(b)] - robot_m;
          ranges.push_back(
              {robot_m, 1.2 * away_m.norm() + 0.3 + (k % 2 == 0 ? kError_m : -kError_m), b});
          Eigen::VectorXd J = Eigen::VectorXd::Zero(size);
          J.head<2>() << away_m.norm(), 1.0;
          J.segment<2>(2 + 2 * b) = 1.2 * away_m.normalized();
          sum += J * J.transpose();
        }
      }
      const RangeFit fit = fit_at({ranges, 30.0, {}, {1e5, 1e5}}, state);
      ASSERT_EQ(fit.correlation, 1.0) << count;
      const double left = count - 2.0 - 2.0 / beacons;
      const double small = left > 1.0 ? count / left : count;
      const Eigen::MatrixXd C = small * std::pow(density.score / density.slope, 2) * sum.inverse();
      for (int b = 0; b < beacons; ++b) {
        const FittedBeacon& beacon = fit.beacons[index(b)];
        const Eigen::Matrix2d of_place_m2 = C.block<2, 2>(2 + 2 * b, 2 + 2 * b);
        EXPECT_LT((beacon.covariance_m2() - of_place_m2).norm(), 1e-4 * of_place_m2.norm())
            << beacons << " " << count;
        EXPECT_NEAR(beacon.joint(0, 0), C(0, 0), 1e-4 * C(0, 0)) << beacons << " " << count;
        EXPECT_NEAR(beacon.joint(3, 1), C(3 + 2 * b, 1), 1e-3 * std::abs(C(3 + 2 * b, 1)));
        EXPECT_NEAR(beacon.range_sigma_m, kError_m, 1e-9);
      }
    }
  }
}

// Each beacon's noise is combined with the common noise of all beacons, which has the weight of
// twenty ranges.
TEST(FitAt, UsesTheCommonNoiseForABeaconWithFewRanges) {
  const RangeState state{{1.0, 0.0}, {{9.0, 4.0}, {-6.0, 7.0}}, {{0.5, 0.0}, {0.5, 0.0}}};
  std::vector<TakenRange> ranges;
  const int counts[] = {5, 45};
  const double errors_m[] = {0.3, 0.1};
  for (int b = 0; b < 2; ++b) {
    for (int k = 0; k < counts[b]; ++k) {
      const Eigen::Vector2d robot_m(-5.0 + 17.0 * std::sin(1.0 + k), 13.0 * std::cos(2.5 * k));
      const double error_m = k % 2 == 0 ? errors_m[b] : -errors_m[b];
      ranges.push_back({robot_m, (state.beacons_m[index(b)] - robot_m).norm() + error_m, b});
    }
  }
  const RangeProblem problem{ranges, 30.0, {}, {}};
  const double of_all_m2 = (5 * 0.09 + 45 * 0.01) / 50.0;
  const RangeFit fit = fit_at(problem, state);
  EXPECT_NEAR(fit.beacons[0].range_sigma_m, std::sqrt((5 * 0.09 + 20 * of_all_m2) / 25.0), 1e-9);
  EXPECT_NEAR(fit.beacons[1].range_sigma_m, std::sqrt((45 * 0.01 + 20 * of_all_m2) / 65.0), 1e-9);
  // The expected width is the most likely one, with each error weighted by (ν + 1)/(ν + x²).
  double squares_m2[2];
  for (int b = 0; b < 2; ++b) {
    const double e2 = errors_m[b] * errors_m[b];
    squares_m2[b] = counts[b] * e2 * 6.0 / (5.0 + e2 / 0.25);  // (ν + 1)/(ν + x²), ν = 5
  }
  RangeState refined = state;
  refine(problem, refined, 1);
  const double widths_m2 = (squares_m2[0] + squares_m2[1]) / 50.0;
  for (int b = 0; b < 2; ++b) {
    EXPECT_NEAR(refined.noise[index(b)].width_m,
                std::sqrt((squares_m2[b] + 20.0 * widths_m2) / (counts[b] + 20.0)), 1e-9);
    EXPECT_EQ(refined.noise[index(b)].outlier_share, 1e-3) << "lower limit of the outlier share";
  }
}

}  // namespace
}  // namespace vantage::estimator
