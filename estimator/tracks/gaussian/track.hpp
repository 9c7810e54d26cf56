#pragma once

#include <optional>

#include "core/time.hpp"
#include "models/belief/gaussian.hpp"
#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"
#include "scenario/scenario.hpp"

// Operations on the belief of one target: prediction, discovery, measurement. They have no side
// effects and do not allocate.

namespace vantage::estimator {

/// One robot's track of a target. Until the target is discovered, only `known` is valid.
struct Track {
  bool known = false;
  models::Information information;
  Time last_seen{};  ///< time of the newest measurement, by any robot, that the track contains
  /// time of the newest measurement that was outside the gate, since the last used one; 0: none
  Time doubted{};
};

/// True if mean and covariance are equal, without tolerance.
bool is_same(const models::Gaussian& a, const models::Gaussian& b);

/// Predicts the belief from `from` to `to` ≥ `from`, exactly, for any interval:
///   Ω ← (A Ω⁻¹ Aᵀ + W)⁻¹, ω ← Ω (c + A (ŷ − c))
/// with A and W of the complete interval. Predicting in two parts gives the same result. A model
/// whose uncertainty grows while the target is unseen adds its grown_noise() with k = (t −
/// last_seen)/τ; at multiples of the step this is Σ q k, the sum of the noise of the steps. Returns
/// nullopt when Ω cannot be inverted.
std::optional<models::Information> propagate(const models::TargetModel& model, double step_s,
                                             const models::Information& information, Time last_seen,
                                             Time from, Time to);

/// Greatest deviation of h from its tangent, in σ of the noise, at which a measurement is
/// linearised about the belief's mean: √(bᵀ V⁻¹ b), b = h(y) − h(ŷ) − H (y − ŷ). The deviation is
/// tested at the corners y, at 1.5σ along each axis of the belief. Below this limit, in 95 of 100
/// cases, the linearised posterior's mean was wrong by less than 0.13 σ and its covariance by less
/// than 10 %. Above this limit the errors are much larger (docs/decisions/0011).
inline constexpr double kBendMax = 0.2;

/// Result of using one measurement.
enum class [[nodiscard]] Use{kUsed, kGated, kSingular};

/// Adds one measurement to a belief. The update is linear if h is nearly linear about the mean
/// (kBendMax) and the posterior is at least 3σ from the limits of range and view:
///   Ω ← Ω + Hᵀ V⁻¹ H, ω ← ω + Hᵀ V⁻¹ z̃ with z̃ = z − h(x, ŷ) + H ŷ, bearings wrapped.
/// Otherwise the position's marginal is set to the posterior_moments(), and the velocity changes
/// through its correlation. This happens near or below the robot, after a long time without
/// detection, and at the edge of view.
/// For a sensor that measures velocity, H has columns for the velocity, the limits of range and
/// view are ignored, and an unscented_update() of the whole state replaces the posterior_moments().
/// @param gate_sigma  > 0: returns kGated, belief unchanged, when z is farther than this from the
/// prediction: √(νᵀ (H Ω⁻¹ Hᵀ + V)⁻¹ ν), or the square root of PositionMoments::mahalanobis2
/// Returns kSingular, belief unchanged, when Ω or V is not positive definite, or no position is
/// compatible with z.
/// Precondition: z has measurement_dim rows.
/// Cost: about 1 µs if linear, else that of posterior_moments(). No allocation.
/// Source: dissertation, section 3.3; algorithms §4.
Use measure(models::Information& belief, const models::SensorModel& sensor,
            const models::Viewpoint& from, const models::Measurement& measurement,
            double gate_sigma);

/// True if one detection determines a target's position: false for a sensor of range or bearing
/// alone.
bool can_discover(const models::SensorModel& sensor);

/// Returns the belief of a target after its first detection. Position: posterior_moments() of z
/// over the field of view, without prior. Directions that z does not measure (the null space of
/// ∂h/∂position at the position that explains z) have the prior prior_position_sigma_m. Velocity:
/// zero with prior_velocity_sigma_mps, or with the model's stationary velocity σ for a damped
/// oscillator. Returns nullopt if the sensor cannot determine the position.
std::optional<models::Information> discover(const scenario::EstimatorSpec& spec,
                                            const models::SensorModel& sensor,
                                            const models::Viewpoint& from,
                                            const models::Measurement& measurement);

/// Probability that a detection outside the gate has the right id, because its target moved
/// unexpectedly. Otherwise the detection belongs to another target.
inline constexpr double kDoubt = 0.5;

/// Handles a detection with this track's id at `time` that was outside the gate. The mean does not
/// change. The covariance is enlarged towards the belief that discover() gives for the detection
/// alone, with share kDoubt: Σ ← Σ + kDoubt (Σ_z + d dᵀ), d from the mean to that belief's mean.
/// The next detection is then within the gate, both at the old position and at the position of this
/// detection. Until the robot detects the target again, it fuses a received belief only if the
/// belief includes a detection made at `time` or later. Returns false and leaves the track
/// unchanged if the sensor cannot determine the position.
bool doubt(Track& track, const scenario::EstimatorSpec& spec, const models::SensorModel& sensor,
           const models::Viewpoint& from, const models::Measurement& measurement, Time time);

}  // namespace vantage::estimator
