#pragma once

#include "models/belief/gaussian.hpp"
#include "models/sensor/sensor.hpp"
#include "models/world/world.hpp"

namespace vantage::estimator {

/// Whether a look from there may report a target at `target_m`: models::in_view and line of sight.
bool can_report(const models::SensorModel& sensor, const models::Viewpoint& from,
                const models::World& world, const models::PositionVector& target_m);

/// A look that did not report a target although the belief expected it says where the target is
/// not: the moments of N(y; μ, P) · (1 − p_D · 1[y in view]) / Z ("negative information"). See
/// reweighted() for how, and for what is returned unchanged; also p_D ≤ 0 and a belief beyond reach
/// of the sensor.
///
/// "In view" is can_report().
/// @param probability  if not null: Z, that of the look not reporting the target
/// Cost: at most 343 line-of-sight queries, no allocation.
/// Source: Ristic, Arulampalam, Gordon, Beyond the Kalman Filter (2004), 11.3 (no-detection
/// likelihood).
models::Gaussian missed_detection(const models::Gaussian& belief, const models::SensorModel& sensor,
                                  const models::Viewpoint& from, const models::World& world,
                                  double detection_probability, double* probability = nullptr);

}  // namespace vantage::estimator
