#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "models/sensor/sensor.hpp"

namespace vantage::estimator {

/// Distance below which the direction to a beacon is undefined.
inline constexpr double kRangeNearest_m = 1e-6;

struct RangeOnlySpec {
  models::RangeCalibration calibration;
  double range_sigma_m = 0.5;     ///< 1σ of an honest range
  double outlier_share = 0.05;    ///< share of ranges that are outliers
  double outlier_span_m = 100.0;  ///< m; outliers are uniform over this span
  int hypotheses = 48;            ///< Gaussians on the first ring; also the maximum number
  double weight_min = 1e-4;       ///< lighter hypotheses are dropped
  /// Hypotheses nearer than this, in σ of their own or of a range, are merged.
  double merge_distance_sigma = 0.5;
  int restart_window = 30;  ///< ranges; restart if most in one window match no hypothesis
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
/// The first range puts the beacon on a ring: `hypotheses` Gaussians around the robot. Every
/// further range updates each of them by an EKF. Its innovation is either honest, N(0, S), or an
/// outlier (uniform). With posterior probability β of being honest, the update is that of
/// probabilistic data association: x + βKν, P − βKSKᵀ + β(1 − β) KννᵀKᵀ. The weight follows the
/// mixture's likelihood. Hypotheses of small weight are dropped and similar ones merged until one
/// remains. Sequential, one pass.
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

  /// Returns the heaviest hypothesis; weight 0 before the first range.
  [[nodiscard]] BeaconHypothesis best() const;
  /// Returns all hypotheses, heaviest first; weights sum to 1.
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
  int window_ = 0;       ///< ranges in the current window
  double honest_ = 0.0;  ///< Σ β over it, each range's largest β of all hypotheses
  std::int64_t refused_ = 0;
  std::int64_t restarts_ = 0;
};

}  // namespace vantage::estimator
