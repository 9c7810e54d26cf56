#pragma once

#include <optional>

#include "models/belief/gaussian.hpp"
#include "models/sensor/sensor.hpp"

namespace vantage::estimator {

/// Belief after a measurement, and measures of how well the measurement matches the prior belief.
struct Unscented {
  models::Gaussian belief;
  double likelihood = 0.0;           ///< density, without its constant factor
  double relative_likelihood = 0.0;  ///< exp(−½ mahalanobis2), 1 for a perfect match
  double mahalanobis2 = 0.0;         ///< νᵀ S⁻¹ ν
};

/// Updates a planar belief by an unscented Kalman filter. The points vary the position; the
/// velocity changes through its correlation. For a sensor that measures velocity, the points vary
/// the whole state (x, y, ẋ, ẏ). Returns nullopt if a matrix is singular. No allocation. Source:
/// Julier and Uhlmann 1997, with the symmetric points at ±√n σ.
std::optional<Unscented> unscented_update(const models::Gaussian& belief,
                                          const models::SensorModel& sensor,
                                          const models::Viewpoint& from,
                                          const models::Measurement& measurement);

}  // namespace vantage::estimator
