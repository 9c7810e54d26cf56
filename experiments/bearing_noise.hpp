#pragma once

#include "models/sensor/kind.hpp"

namespace vantage::experiments {

/// Range and bearing of which each is the noisier the larger it is: V = diag(σ_r² g(r / range_max),
/// σ_b² g(|β| / (φ/2))), g(x) = max(variance_floor, x), β from body x; of a full turn φ/2 is π. The
/// range's variance is constant without `variance_grows_with_range`. Everything else is as of
/// SensorKind::kRangeBearing, whose two variances both grow with the range. Information depends on
/// the heading and so has no planar law: planners ask look by look.
/// Source: dissertation after eq. 3.8 and in 4 F.1 ("the noise covariance grows linearly in range
/// and in bearing, up to σ_r², and σ_b²"), read literally.
models::SensorKind range_bearing_by_bearing();

}  // namespace vantage::experiments
