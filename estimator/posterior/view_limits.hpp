#pragma once

#include "models/sensor/sensor.hpp"

// Soft limits of range, depth and view. A sensor's limits are sharp, but their position in the
// world is uncertain, because the robot's pose and the measurement are. So the probability of being
// in view falls off smoothly at a limit.

namespace vantage::estimator {

/// 1σ of the position of the limits; 0: exact.
struct LimitSoftness {
  /// m; limits of range and depth, and lateral position of the edges of view
  double distance_m = 0.0;
  double angle_rad = 0.0;  ///< rad; additional angle of the edges of view
};

/// 1σ of a limit as a share of 1σ of the measurement noise. Determined by experiment
/// (docs/decisions/0021).
inline constexpr double kSoftShare = 0.1;

/// Returns the softness for noise covariance V: kSoftShare times 1σ of a range or a position
/// coordinate (distance_m), and kSoftShare times 1σ of a bearing or a camera's line of sight
/// (angle_rad). Limits are exact for a sensor kind that measures something else or defines its own
/// limits.
LimitSoftness limit_softness(const models::SensorModel& sensor, const models::MeasurementMatrix& V);

/// Returns the probability that a target at `target_m` is in view: the product of Φ(distance from
/// the limit in σ) over all limits. For exact limits, and for a sensor kind that defines its own
/// limits, it is 1 or 0 as given by models::in_view(). No allocation.
double view_probability(const models::SensorModel& sensor, const LimitSoftness& softness,
                        const models::Viewpoint& from, const models::PositionVector& target_m);
/// Returns view_probability() of a target at distance `range_m`, horizontal distance `horizontal_m`
/// and bearing `bearing_rad` from body x. `depth_m` is +∞ for a sensor without a minimum depth.
double view_probability(const models::SensorModel& sensor, const LimitSoftness& softness,
                        double range_m, double horizontal_m, double bearing_rad, double depth_m);

/// Distance from a limit, in σ, beyond which the factor of the limit is set to 1 or 0.
inline constexpr double kViewCertain_sigma = 6.0;

}  // namespace vantage::estimator
