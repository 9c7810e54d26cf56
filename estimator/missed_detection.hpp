#pragma once

#include "models/belief/gaussian.hpp"
#include "models/sensor/sensor.hpp"
#include "models/world/world.hpp"

namespace vantage::estimator {

/// A look that did not report a target although the belief expected it says where the target is
/// not: the posterior is N(y; μ, P) · (1 − p_D · 1[y in view]) / Z, and this returns the Gaussian
/// with the same mean and covariance ("negative information").
///
/// "In view" is models::in_view and line of sight. The moments come from a fixed product rule of
/// 15 points a coordinate (7 for targets in space) on ±3σ of the position ellipse, scaled so that
/// it has the Gaussian's own first two moments: a look that covers nothing, or everything, of it
/// changes nothing. Velocity follows through its correlation with the position. Moment matching
/// may shrink the covariance (the field of view cut off one side) as well as grow it (a hole in
/// the middle); it never goes below the variance of one cell of the rule, in no direction, so the
/// result stays symmetric positive definite.
///
/// Returned unchanged: p_D ≤ 0, a belief beyond reach of the sensor, a look that contradicts the
/// belief altogether (Z < 1e−6), a covariance that is not positive definite.
/// Cost: at most 343 line-of-sight queries, no allocation.
/// Source: Ristic, Arulampalam, Gordon, Beyond the Kalman Filter (2004), 11.3 (no-detection
/// likelihood); moment matching as in any assumed-density filter.
models::Gaussian missed_detection(const models::Gaussian& belief, const models::SensorModel& sensor,
                                  const models::Viewpoint& from, const models::World& world,
                                  double detection_probability);

}  // namespace vantage::estimator
