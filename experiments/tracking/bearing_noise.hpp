#pragma once

#include "models/sensor/kind.hpp"

namespace vantage::experiments {

/// Returns a range and bearing sensor. The variance of the range grows with the range, and the
/// variance of the bearing with the bearing: V = diag(σ_r² g(r / range_max), σ_b² g(|β| / (φ/2))),
/// g(x) = max(variance_floor, x), β from body x. For a full-circle field of view φ/2 is π. Without
/// `variance_grows_with_range` the variance of the range is constant. All other properties equal
/// those of SensorKind::kRangeBearing, for which both variances grow with the range. Information
/// depends on the heading, so the sensor has no PlanarLaw, and planners evaluate each observation
/// separately.
/// Source: dissertation after eq. 3.8 and in section 4.F.1 ("the noise covariance grows linearly in
/// range and in bearing, up to σ_r², and σ_b²"), read literally.
models::SensorKind range_bearing_by_bearing();

}  // namespace vantage::experiments
