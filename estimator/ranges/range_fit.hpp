#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "models/sensor/sensor.hpp"

// Joint estimation of static beacons and of the ranging sensor's calibration from a complete
// recording with known robot positions.

namespace vantage::estimator {

/// One range measurement, r = range_scale ‖y − p‖ + range_bias_m + v.
struct TakenRange {
  Eigen::Vector2d robot_m = Eigen::Vector2d::Zero();  ///< position p of the robot
  double range_m = 0.0;
  int beacon = 0;  ///< index of the beacon at y, from 0
};

/// Prior of the calibration.
struct RangeFitSpec {
  double range_scale_sigma = 0.2;   ///< 1σ; the mean is 1
  double range_bias_sigma_m = 2.0;  ///< m, 1σ; the mean is 0
};

/// Covariance of (range_scale, range_bias_m, x of a beacon, y of this beacon), in this order.
using CalibratedCovariance = Eigen::Matrix<double, 4, 4, kUnaligned>;

struct FittedBeacon {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  CalibratedCovariance joint = CalibratedCovariance::Zero();
  double range_sigma_m = 0.0;  ///< m; 1σ of this beacon's ranges without the outliers
  double outlier_share = 0.0;  ///< share of outliers among this beacon's ranges
  double probability = 1.0;    ///< probability that position_m is the true position
  /// m; most likely alternative position, if any
  std::optional<Eigen::Vector2d> other;

  [[nodiscard]] Eigen::Matrix2d covariance_m2() const { return joint.bottomRightCorner<2, 2>(); }
};

struct RangeFit {
  models::RangeCalibration calibration;
  double range_scale_sigma = 0.0;   ///< 1σ
  double range_bias_sigma_m = 0.0;  ///< 1σ
  /// Number of correlated ranges that have the information of one independent range; ≥ 1.
  double correlation = 1.0;
  std::vector<FittedBeacon> beacons;
};

/// m; largest range and robot coordinate that fit_ranges() accepts. With larger numbers, squares
/// overflow or all other terms are lost by rounding.
inline constexpr double kRangeBound_m = 1e6;
/// True if fit_ranges() accepts the range: it is finite and within the bound.
bool is_within_bound(const TakenRange& range);

/// Least number of ranges per beacon that fit_ranges() accepts; fewer do not determine the
/// position.
inline constexpr int kRangesOfBeaconMin = 10;

/// Computes the most likely calibration and positions of `beacons` beacons, with covariances.
///
/// The error v is either an inlier or an outlier. Inliers follow Student's t of 5 degrees of
/// freedom with a separate width per beacon. Outliers are uniform over a span given by the 95 %
/// quantile of the ranges, with a separate share per beacon. RangeOnlyFilter gives one start for
/// each calibration of a grid. The best start is refined by expectation maximisation with
/// Gauss-Newton steps. Every beacon is also tried at each of its positions in the other starts. The
/// covariances are valid for any noise distribution: A⁻¹ B A⁻¹, with A from the slopes and B from
/// the squares of the residuals' scores; B is multiplied by `correlation`. The ranges of one beacon
/// must be sorted by time. Deterministic.
/// Cost: O(beacons · 300) for the starts, then O(ranges) per step and O(beacons³).
/// @throws UsageError for a range that is not within the bound, a beacon out of range or one with
/// fewer than kRangesOfBeaconMin ranges, and when no start has a finite likelihood.
/// Source: Lange, Little, Taylor (1989), t by EM; Huber (1967), A⁻¹ B A⁻¹; Geyer (1992), initial
/// positive sequences, for `correlation`.
RangeFit fit_ranges(std::span<const TakenRange> ranges, int beacons, const RangeFitSpec& spec = {});

/// Innovations of ranges that were not used in the fit, normalised by the σ that the fit predicts.
struct InnovationScore {
  int inliers = 0;   ///< number of ranges within 4σ of the prediction
  int outliers = 0;  ///< number of ranges beyond 4σ; not part of nees
  /// Mean of ν²/(H Σ Hᵀ + σ²) over the ranges counted in `inliers`; 1 if the fit is consistent.
  double nees = 0.0;
};
InnovationScore judge(const RangeFit& fit, std::span<const TakenRange> ranges);

}  // namespace vantage::estimator
