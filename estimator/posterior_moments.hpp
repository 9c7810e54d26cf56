#pragma once

#include <optional>

#include "models/belief/gaussian.hpp"
#include "models/sensor/sensor.hpp"

namespace vantage::estimator {

/// What was known of a position before a measurement: exp(−½ (y − mean)ᵀ Ω (y − mean)), Ω positive
/// semidefinite; Ω = 0 says nothing.
struct PositionPrior {
  models::PositionVector mean_m;
  models::PositionMatrix information;  ///< Ω, m⁻²
};

/// Mean and covariance of a position after a measurement.
struct PositionMoments {
  models::PositionVector mean_m;
  models::PositionMatrix covariance_m2;
  /// Least over y of (y − mean)ᵀ Ω (y − mean) + (z − h(y))ᵀ V⁻¹ (z − h(y)), to about 0.05: how far
  /// measurement and prior are apart, squared, in σ. For a linear sensor it is νᵀ S⁻¹ ν.
  double mahalanobis2 = 0.0;
};

/// Whether posterior_moments() knows how to integrate over what `sensor` measures of targets with
/// `position_dim` coordinates. Not, in space, over a kind that is neither linear nor of ranges,
/// bearings or directions.
bool can_integrate(const models::SensorModel& sensor, Eigen::Index position_dim);

/// The moments of p(y) ∝ prior(y) · N(z; h(y), V) · P(y in view), by quadrature on the sensor's own
/// geometry. z was reported, so the target was in view, as far as it is known where view ends
/// (view_limits.hpp); unless less than a thousandth of what prior and z leave possible is: then the
/// limits are not what the sensor keeps to, and are not used.
///
/// Seen from the sensor, prior and range are one Gaussian along each ray, bearings (and a camera's
/// image) are constant on it. So p is integrated along each ray by 12 Gauss-Legendre nodes over
/// where it is not negligible, which ends a few σ beyond the limits of range and depth, and over
/// the rays by the midpoint rule: 64 bearings in the plane, 32 × 32 directions in space. The fan
/// starts as wide as view and bearing noise allow and is narrowed (at most 10 times) to the
/// directions that count, so neither a beacon far away nor a target under the robot is missed. A
/// camera over targets on the ground bends along the rays, and other kinds may; there p is
/// integrated on 31 × 31 points of the linearised posterior's own axes.
///
/// nullopt: !can_integrate, V is not positive definite, z leaves nothing possible, or nothing
/// bounds y. Cost: some 20 to 40 µs in the plane (a camera 150 µs), 1 ms in space; no allocation. A
/// pure function.
std::optional<PositionMoments> posterior_moments(const PositionPrior& prior,
                                                 const models::SensorModel& sensor,
                                                 const models::Viewpoint& from,
                                                 const models::Measurement& measurement);

}  // namespace vantage::estimator
