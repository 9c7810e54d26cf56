#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "models/sensor/sensor.hpp"

// Static beacons and the calibration of the sensor that ranges to them, found together from a whole
// recording, the ranging robot's places known.

namespace vantage::estimator {

/// One range, r = range_scale ‖y − p‖ + range_bias_m + v.
struct TakenRange {
  Eigen::Vector2d robot_m = Eigen::Vector2d::Zero();  ///< p
  double range_m = 0.0;
  int beacon = 0;  ///< which y, counted from 0
};

/// What is thought of the calibration before any range.
struct RangeFitSpec {
  double range_scale_sigma = 0.2;   ///< 1σ about 1
  double range_bias_sigma_m = 2.0;  ///< 1σ about 0
};

/// (range_scale, range_bias_m, x of a beacon, y of it): the order of `FittedBeacon::joint`.
using CalibratedCovariance = Eigen::Matrix<double, 4, 4, kUnaligned>;

struct FittedBeacon {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  CalibratedCovariance joint = CalibratedCovariance::Zero();
  double range_sigma_m = 0.0;            ///< 1σ of its honest ranges
  double outlier_share = 0.0;            ///< of its ranges
  double probability = 1.0;              ///< that it is here and not in one of the other places
  std::optional<Eigen::Vector2d> other;  ///< the likeliest of those, m; none: there is none

  [[nodiscard]] Eigen::Matrix2d covariance_m2() const { return joint.bottomRightCorner<2, 2>(); }
};

struct RangeFit {
  models::RangeCalibration calibration;
  double range_scale_sigma = 0.0;   ///< 1σ
  double range_bias_sigma_m = 0.0;  ///< 1σ
  double correlation = 1.0;         ///< so many ranges say as much as one would whose error is its
                                    ///< own; at least 1
  std::vector<FittedBeacon> beacons;
};

/// Greatest range, and greatest coordinate of a robot, that is fitted to: squares of larger numbers
/// overflow or hide all others.
inline constexpr double kRangeBound_m = 1e6;
/// True for a range that fit_ranges() takes: finite and within the bound.
bool is_within_bound(const TakenRange& range);

/// Fewer ranges than this tell too little of a beacon.
inline constexpr int kRangesOfBeaconMin = 10;

/// The likeliest calibration and places of `beacons` beacons, with covariances.
///
/// v is honest, Student's t of 5 degrees of freedom and a width of the beacon's own, or an outlier,
/// uniform over the ranges there are, with a share of the beacon's own. Starts come from
/// RangeOnlyFilter, at each of a grid of calibrations; the best is refined by expectation
/// maximisation with Gauss-Newton steps, every beacon tried at each place that any start gave.
/// Covariances are those of the estimate, whatever the noise is: A⁻¹ B A⁻¹ with A from the slope
/// and B from the square of the residuals' scores, B times `correlation`.
/// Ranges of one beacon in the order of time; deterministic. O(beacons · 300) for the starts, then
/// O(ranges) a step and O(beacons³).
/// @throws UsageError for a range that is not within the bound, a beacon out of range or one with
///         fewer than kRangesOfBeaconMin ranges, and when no start has a likelihood.
/// Source: Lange, Little, Taylor (1989), t by EM; Huber (1967), A⁻¹ B A⁻¹; Geyer (1992), initial
/// positive sequences, for `correlation`.
RangeFit fit_ranges(std::span<const TakenRange> ranges, int beacons, const RangeFitSpec& spec = {});

/// How far ranges that were not fitted to are from what a fit expects, in its own σ.
struct InnovationScore {
  int honest = 0;     ///< ranges within 4σ of what is expected
  int outliers = 0;   ///< the others; they do not count
  double nees = 0.0;  ///< mean of ν²/(H Σ Hᵀ + σ²) over the honest; 1 is right
};
InnovationScore judge(const RangeFit& fit, std::span<const TakenRange> ranges);

}  // namespace vantage::estimator
