#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "models/sensor/sensor.hpp"

namespace vantage::estimator {

/// m; distance below which the direction to a beacon is undefined.
inline constexpr double kRangeNearest_m = 1e-6;

struct RangeOnlySpec {
  models::RangeCalibration calibration;
  double range_sigma_m = 0.5;     ///< m; 1σ of a range that is not an outlier
  double outlier_share = 0.05;    ///< share of ranges that are outliers
  double outlier_span_m = 100.0;  ///< m; outliers are uniform over this span
  int hypotheses = 48;            ///< initial number of Gaussians, which is also the maximum
  double weight_min = 1e-4;       ///< hypotheses of smaller weight are dropped
  /// Distance below which two hypotheses are merged, in σ of the hypotheses or of a range.
  double merge_distance_sigma = 0.5;
  /// number of ranges in a window; the filter restarts if most ranges of a window match no
  /// hypothesis
  int restart_window = 30;
};

/// One hypothesis of a Gaussian sum for a beacon's position.
struct BeaconHypothesis {
  double weight = 1.0;
  Eigen::Vector2d mean_m = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 2, kUnaligned> covariance_m2 = Eigen::Matrix2d::Identity();
};

/// Filter that locates a static planar beacon from ranges alone, r = range_scale ‖y − p‖ +
/// range_bias_m + v, with known positions p of the robot.
///
/// The first range gives a ring of `hypotheses` Gaussians around the robot. Every further range
/// updates each Gaussian by an EKF. A range is either an outlier (uniform) or an inlier with
/// innovation N(0, S). With β the posterior probability of an inlier, the update is that of
/// probabilistic data association: x + βKν, P − βKSKᵀ + β(1 − β) KννᵀKᵀ. Each weight is multiplied
/// by the likelihood of the range as an inlier or an outlier. Hypotheses of small weight are
/// dropped and similar ones are merged until one remains. Each range is used once, in sequence.
/// Cost: O(hypotheses) per range, and O(hypotheses²) while there are several.
/// Source: Alspach, Sorenson (1972), Gaussian sums; Bar-Shalom, Li, Kirubarajan (2001), 3.4 PDA;
/// Djugash, Hamner, Roth (2009) for rings of range-only hypotheses.
class RangeOnlyFilter {
 public:
  /// @throws UsageError for an invalid spec.
  explicit RangeOnlyFilter(RangeOnlySpec spec);

  /// Uses one range measured from `robot_m`. Ranges that are not finite, or that the calibration
  /// maps to zero or below, are counted and dropped.
  void update(const Eigen::Vector2d& robot_m, double range_m);

  /// Returns the hypothesis with the largest weight. Its weight is 0 before the first range.
  [[nodiscard]] BeaconHypothesis best() const;
  /// Returns all hypotheses, sorted by decreasing weight; weights sum to 1.
  [[nodiscard]] const std::vector<BeaconHypothesis>& hypotheses() const { return hypotheses_; }
  [[nodiscard]] std::int64_t refused() const { return refused_; }
  [[nodiscard]] std::int64_t restarts() const { return restarts_; }

 private:
  void start_ring(const Eigen::Vector2d& robot_m, double distance_m);
  double update(BeaconHypothesis& hypothesis, const Eigen::Vector2d& robot_m, double range_m) const;
  void normalise_and_drop();
  void merge();

  RangeOnlySpec spec_;
  std::vector<BeaconHypothesis> hypotheses_;
  int window_ = 0;  ///< number of ranges in the current window
  /// sum, over the ranges of the window, of the largest β of all hypotheses
  double inliers_ = 0.0;
  std::int64_t refused_ = 0;
  std::int64_t restarts_ = 0;
};

}  // namespace vantage::estimator
