#pragma once

#include "models/sensor/sensor.hpp"

// The limits of range, depth and view as evidence. They are as sharp as a sensor's parts are; where
// they lay in the world is known no better than where the robot was and what it measured, and how a
// belief falls off there, a Gaussian does not know.

namespace vantage::estimator {

/// 1σ of where limits lie; 0: exactly.
struct LimitSoftness {
  double distance_m = 0.0;  ///< of those of range and depth, and of the edges of view sideways
  double angle_rad = 0.0;   ///< beside that, of the edges of view
};

/// Limits are known to this share of what is measured: 1σ of it in 1σ of the noise. Measured
/// (docs/decisions/0021).
inline constexpr double kSoftShare = 0.1;

/// Of looks with noise covariance V: kSoftShare of 1σ of a range or of a coordinate of a position,
/// of a bearing or of a camera's line of sight. A kind that measures something else, or has limits
/// of its own: exactly.
LimitSoftness limit_softness(const models::SensorModel& sensor, const models::MeasurementMatrix& V);

/// Probability that a target there is in view: Φ of its distance from each limit in σ, multiplied.
/// With limits that are known exactly, and for a kind with limits of its own, 1 or 0 as
/// models::in_view() has it. No allocation.
double view_probability(const models::SensorModel& sensor, const LimitSoftness& softness,
                        const models::Viewpoint& from, const models::PositionVector& target_m);
/// The same of a target that is `range_m` away, `horizontal_m` of it horizontally, at `bearing_rad`
/// from body x; `depth_m`: +∞ for a sensor that has no least one.
double view_probability(const models::SensorModel& sensor, const LimitSoftness& softness,
                        double range_m, double horizontal_m, double bearing_rad, double depth_m);

/// Farther than this from every limit it is 1 or 0.
inline constexpr double kViewCertain_sigma = 6.0;

}  // namespace vantage::estimator
