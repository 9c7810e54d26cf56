#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "estimator/range_fit.hpp"
#include "models/sensor/sensor.hpp"

// The inside of fit_ranges(): from a start to the likeliest places near it.

namespace vantage::estimator {

/// Of one beacon's ranges.
struct RangeNoise {
  double width_m = 1.0;  ///< of Student's t
  double outlier_share = 0.1;
};

struct RangeProblem {
  std::span<const TakenRange> ranges;
  double outlier_span_m = 1.0;
  models::RangeCalibration prior;  ///< the calibration's mean before any range
  RangeFitSpec spec;               ///< and its 1σ
};

struct RangeState {
  models::RangeCalibration calibration;
  std::vector<Eigen::Vector2d> places_m;  ///< by beacon
  std::vector<RangeNoise> noise;          ///< by beacon
};

/// What one residual tells.
struct ResidualVerdict {
  double nats = 0.0;    ///< log density
  double honest = 1.0;  ///< probability that it is no outlier
  double score = 0.0;   ///< ψ = −d nats/d residual, 1/m
  double slope = 0.0;   ///< dψ/d residual, 1/m²
  double weight = 0.0;  ///< ψ/residual, 1/m²; positive
};
ResidualVerdict verdict_of(double residual_m, const RangeNoise& noise, double outlier_span_m);

/// r − (range_scale ‖y − p‖ + range_bias_m).
double residual_m(const RangeState& state, const TakenRange& range);

/// Noise as the residuals of `state` suggest, for a start.
void guess_noise(const RangeProblem& problem, RangeState& state);

/// Log density of all ranges and of the calibration.
double log_posterior(const RangeProblem& problem, const RangeState& state);

/// Climbs to the top near `state`, in at most `rounds` rounds; its log posterior.
double refine(const RangeProblem& problem, RangeState& state, int rounds);

/// The fit with its covariances, at a state that is refined. Alternatives are left out.
RangeFit fit_at(const RangeProblem& problem, const RangeState& state);

}  // namespace vantage::estimator
