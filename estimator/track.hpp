#pragma once

#include <optional>

#include "core/time.hpp"
#include "models/belief/gaussian.hpp"
#include "models/scenario/scenario.hpp"
#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"

// What happens to the belief of one target: it is carried through time, discovered, measured.
// Pure; nothing here allocates.

namespace vantage::estimator {

/// One target as one robot knows it; until its discovery nothing but `known` means anything.
struct Track {
  bool known = false;
  models::Information information;
  Time last_seen{};  ///< newest measurement of anyone that went into it
};

/// The belief of instant `from` brought to `to` ≥ `from`, exactly, whatever the elapsed time:
/// Ω ← (A Ω⁻¹ Aᵀ + W)⁻¹, ω ← Ω A ŷ with A and W of the whole interval. Carrying it in two parts
/// gives the same. Growing uncertainty adds W = q (f(k_to) − f(k_from)) I with f(k) = k (k + 1)/2
/// and k = (t − last_seen)/τ: at whole steps that is Σ q k, the sum of the steps' own noise.
/// nullopt when Ω cannot be inverted.
std::optional<models::Information> propagate(const models::TargetModel& model, double step_s,
                                             const models::Information& information, Time last_seen,
                                             Time from, Time to);

/// Where h is linearised for one measurement: the position a.
///
/// The belief's mean, as in the dissertation, while the belief is narrow: √tr P_pp within 0.15 of
/// the target's distance. A wider one (a target under the robot, or one not seen for long) would be
/// pulled along the tangent of a circle that bends away; then, for a sensor that tells where the
/// target is, three Gauss-Newton steps from the position that explains z lead to the most likely
/// position (iterated extended Kalman filter). Source: Bell, Cathey (1993).
models::PositionVector linearisation_point(const models::Gaussian& belief,
                                           const models::SensorModel& sensor,
                                           const models::Viewpoint& from,
                                           const models::Measurement& measurement);

/// What became of one measurement.
enum class [[nodiscard]] Use{kUsed, kGated, kSingular};

/// Adds one measurement to a belief, linearised about a = linearisation_point():
/// Ω ← Ω + Hᵀ V⁻¹ H, ω ← ω + Hᵀ V⁻¹ z̃ with z̃ = z − h(x, a) + H a, bearings wrapped.
/// @param gate_sigma  > 0: leave the belief alone (kGated) when the innovation's Mahalanobis
///                    length √(νᵀ (H Ω⁻¹ Hᵀ + V)⁻¹ ν), ν = z̃ − H ŷ, exceeds it
/// kSingular, belief untouched: Ω or V not positive definite, or a at the sensor itself.
/// Precondition: z has measurement_dim rows. Source: dissertation 3.3; algorithms §4.
Use measure(models::Information& belief, const models::SensorModel& sensor,
            const models::Viewpoint& from, const models::Measurement& measurement,
            double gate_sigma);

/// The belief of a target after its very first detection. Position: the one that explains z, with
/// information Jᵀ V⁻¹ J, J = ∂h/∂position there; in directions where z is silent (the null space
/// of J) the stated prior_position_sigma_m. Velocity: zero, prior_velocity_sigma_mps.
/// nullopt for a sensor that cannot tell where the target is (range or bearing alone).
std::optional<models::Information> discover(const models::EstimatorSpec& spec,
                                            const models::SensorModel& sensor,
                                            const models::Viewpoint& from,
                                            const models::Measurement& measurement);

}  // namespace vantage::estimator
