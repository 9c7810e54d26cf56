#pragma once

#include "models/belief/gaussian.hpp"
#include "models/sensor/sensor.hpp"
#include "models/world/world.hpp"

namespace vantage::estimator {

/// True if an observation from `from` can report a target at `target_m`: the target is in view
/// (models::in_view) and in line of sight.
bool can_report(const models::SensorModel& sensor, const models::Viewpoint& from,
                const models::World& world, const models::PositionVector& target_m);

/// Returns the belief updated with an observation that did not report the target ("negative
/// information"). It has the moments of N(y; μ, P) · (1 − p_D · 1[y in view]) / Z, where "in view"
/// is can_report(). See reweighted() for the method and for the cases in which the belief is
/// returned unchanged. The belief is also unchanged if p_D ≤ 0 or if it is beyond the sensor's
/// range.
///
/// @param probability  if not null: receives Z, the probability that the observation does not
/// report the target
/// Cost: at most 343 line-of-sight queries, no allocation.
/// Source: Ristic, Arulampalam, Gordon, Beyond the Kalman Filter (2004), 11.3 (no-detection
/// likelihood).
models::Gaussian missed_detection(const models::Gaussian& belief, const models::SensorModel& sensor,
                                  const models::Viewpoint& from, const models::World& world,
                                  double detection_probability, double* probability = nullptr);

}  // namespace vantage::estimator
