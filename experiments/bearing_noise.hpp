#pragma once

#include "models/sensor/kind.hpp"

namespace vantage::experiments {

/// Returns a range and bearing sensor. The range's variance grows with the range, the bearing's
/// with the bearing: V = diag(σ_r² g(r / range_max), σ_b² g(|β| / (φ/2))), g(x) =
/// max(variance_floor, x), β from body x. With all-round view φ/2 is π. Without
/// `variance_grows_with_range` the range's variance is constant. Everything else equals
/// SensorKind::kRangeBearing, for which both variances grow with the range. Information depends on
/// the heading, so there is no planar law, and planners evaluate each observation separately.
/// Source: dissertation after eq. 3.8 and in 4 F.1 ("the noise covariance grows linearly in range
/// and in bearing, up to σ_r², and σ_b²"), read literally.
models::SensorKind range_bearing_by_bearing();

}  // namespace vantage::experiments
