#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "models/sensor/sensor.hpp"

namespace vantage::estimator {

/// Nearer than this a beacon has no direction.
inline constexpr double kRangeNearest_m = 1e-6;

struct RangeOnlySpec {
  models::RangeCalibration calibration;
  double range_sigma_m = 0.5;         ///< 1σ of an honest range
  double outlier_share = 0.05;        ///< of ranges that say nothing about the beacon
  double outlier_span_m = 100.0;      ///< these are uniform over so much
  int hypotheses = 48;                ///< Gaussians on the first ring; the most there ever are
  double weight_min = 1e-4;           ///< lighter hypotheses are dropped
  double merge_distance_sigma = 0.5;  ///< hypotheses nearer than this, of their own or of a
                                      ///< range's σ, become one
  int restart_window =
      30;  ///< after so many ranges in a row mostly unlike any hypothesis, start over
};

/// Where a beacon may be: one hypothesis of a Gaussian sum.
struct BeaconHypothesis {
  double weight = 1.0;
  Eigen::Vector2d mean_m = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 2, kUnaligned> covariance_m2 = Eigen::Matrix2d::Identity();
};

/// A static planar beacon found from ranges alone, r = range_scale ‖y − p‖ + range_bias_m + v, with
/// the ranging robot's positions p known.
///
/// One range puts the beacon on a ring: `hypotheses` Gaussians around the robot. Every further
/// range updates each by an EKF whose innovation is either honest, N(0, S), or an outlier
/// (uniform): with posterior probability β of the first, the update is the probabilistic data
/// association one, x + βKν, P − βKSKᵀ + β(1 − β) KννᵀKᵀ, and the weight follows the mixture's
/// likelihood. Light hypotheses are dropped, those that agree merged, until one remains.
/// Sequential, one pass; O(hypotheses) a range, and O(hypotheses²) while there are several.
/// Source: Alspach, Sorenson (1972), Gaussian sums; Bar-Shalom, Li, Kirubarajan (2001), 3.4 PDA;
/// Djugash, Hamner, Roth (2009) for rings of range-only hypotheses.
class RangeOnlyFilter {
 public:
  /// @throws UsageError for a spec that makes no sense.
  explicit RangeOnlyFilter(RangeOnlySpec spec);

  /// Uses one range taken from `robot_m`. Ranges that are not finite or that the calibration maps
  /// below zero are counted and dropped.
  void update(const Eigen::Vector2d& robot_m, double range_m);

  /// The heaviest hypothesis; weight 0 before the first range.
  [[nodiscard]] BeaconHypothesis best() const;
  /// All of them, heaviest first; weights sum to 1.
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
  int window_ = 0;       ///< ranges in the present window
  double honest_ = 0.0;  ///< Σ β of the heaviest hypothesis over it
  std::int64_t refused_ = 0;
  std::int64_t restarts_ = 0;
};

}  // namespace vantage::estimator
