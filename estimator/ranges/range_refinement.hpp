#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "estimator/ranges/range_fit.hpp"
#include "models/sensor/sensor.hpp"

// Refinement step of fit_ranges(): moves from a start to a local maximum of the posterior.

namespace vantage::estimator {

/// Noise model of one beacon's ranges.
struct RangeNoise {
  double width_m = 1.0;  ///< m; width of Student's t
  double outlier_share = 0.1;
};

struct RangeProblem {
  std::span<const TakenRange> ranges;
  double outlier_span_m = 1.0;
  models::RangeCalibration prior;  ///< prior mean of the calibration
  RangeFitSpec spec;               ///< 1σ of the prior of the calibration
};

struct RangeState {
  models::RangeCalibration calibration;
  std::vector<Eigen::Vector2d> beacons_m;  ///< positions, by beacon
  std::vector<RangeNoise> noise;           ///< by beacon
};

/// Log density of one residual and its derivatives.
struct ResidualDensity {
  double nats = 0.0;                ///< log density
  double inlier_probability = 1.0;  ///< probability that the range is an inlier
  double score = 0.0;               ///< ψ = −d nats/d residual, 1/m
  double slope = 0.0;               ///< dψ/d residual, 1/m²
  double weight = 0.0;              ///< ψ/residual, 1/m²; positive
};
ResidualDensity residual_density(double residual_m, const RangeNoise& noise, double outlier_span_m);

/// Returns the residual r − (range_scale ‖y − p‖ + range_bias_m), m.
double residual_m(const RangeState& state, const TakenRange& range);

/// Sets initial noise parameters of `state` from its residuals.
void guess_noise(const RangeProblem& problem, RangeState& state);

/// Returns the log density of all ranges and of the calibration.
double log_posterior(const RangeProblem& problem, const RangeState& state);

/// Moves `state` to a local maximum near it, in at most `rounds` iterations. Returns the log
/// posterior of the result.
double refine(const RangeProblem& problem, RangeState& state, int rounds);

/// Returns the fit and its covariances at a refined state. Alternative positions are not set.
RangeFit fit_at(const RangeProblem& problem, const RangeState& state);

}  // namespace vantage::estimator
