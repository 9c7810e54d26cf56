#pragma once

#include <optional>

#include "core/time.hpp"
#include "models/belief/gaussian.hpp"
#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"
#include "scenario/scenario.hpp"

// What happens to the belief of one target: it is carried through time, discovered, measured.
// Pure; nothing here allocates.

namespace vantage::estimator {

/// One target as one robot knows it; until its discovery nothing but `known` means anything.
struct Track {
  bool known = false;
  models::Information information;
  Time last_seen{};  ///< newest measurement of anyone that went into it
  Time doubted{};    ///< newest one beyond the gate since the last that was used; else none
};

/// The belief of instant `from` brought to `to` ≥ `from`, exactly, whatever the elapsed time:
/// Ω ← (A Ω⁻¹ Aᵀ + W)⁻¹, ω ← Ω (c + A (ŷ − c)) with A and W of the whole interval. Carrying it in
/// two parts gives the same. Growing uncertainty adds its grown_noise() with k = (t − last_seen)/τ:
/// at whole steps Σ q k, the sum of the steps' own noise. nullopt when Ω cannot be inverted.
std::optional<models::Information> propagate(const models::TargetModel& model, double step_s,
                                             const models::Information& information, Time last_seen,
                                             Time from, Time to);

/// A measurement is linearised about the belief's mean where h leaves its tangent by no more than
/// this many σ of the noise, √(bᵀ V⁻¹ b), b = h(y) − h(ŷ) − H (y − ŷ), at the corners y of the
/// belief's axes ±1.5σ out. Up to it the linearised posterior's mean was found less than 0.13 σ off
/// and its covariance less than 10 % in 95 of 100 cases, beyond it far more (docs/decisions/0011).
inline constexpr double kBendMax = 0.2;

/// What became of one measurement.
enum class [[nodiscard]] Use{kUsed, kGated, kSingular};

/// Adds one measurement to a belief. Where h is linear enough about the mean (kBendMax) and the
/// posterior clear of the limits of range and view by 3σ, however soft they are:
/// Ω ← Ω + Hᵀ V⁻¹ H, ω ← ω + Hᵀ V⁻¹ z̃ with z̃ = z − h(x, ŷ) + H ŷ, bearings wrapped. Elsewhere
/// (near the robot, under it, long unseen, at the edge of view) the position's marginal gets the
/// posterior_moments(), and the velocity follows through its correlation.
/// @param gate_sigma  > 0: leave the belief alone (kGated) when z is farther than this from what
///                    was expected: √(νᵀ (H Ω⁻¹ Hᵀ + V)⁻¹ ν), or the square root of
///                    PositionMoments::mahalanobis2
/// kSingular, belief untouched: Ω or V not positive definite, or a z that leaves nothing possible.
/// Cost: about 1 µs linear, else that of posterior_moments(). No allocation.
/// Precondition: z has measurement_dim rows. Source: dissertation 3.3; algorithms §4.
Use measure(models::Information& belief, const models::SensorModel& sensor,
            const models::Viewpoint& from, const models::Measurement& measurement,
            double gate_sigma);

/// Whether one detection tells where a target is: not of a sensor of range or bearing alone.
bool can_discover(const models::SensorModel& sensor);

/// The belief of a target after its very first detection. Position: posterior_moments() of z over
/// all that is in view, with nothing known before but, where z is silent (the null space of
/// ∂h/∂position at the position that explains z), the stated prior_position_sigma_m. Velocity:
/// zero, prior_velocity_sigma_mps.
/// nullopt where the sensor cannot tell where the target is.
std::optional<models::Information> discover(const scenario::EstimatorSpec& spec,
                                            const models::SensorModel& sensor,
                                            const models::Viewpoint& from,
                                            const models::Measurement& measurement);

/// How likely it is that a detection beyond the gate is right, and its target did what no model
/// foresaw; else it is another's.
inline constexpr double kDoubt = 0.5;

/// A detection of this track's id was beyond the gate, at `time`. What is believed stays in its
/// place, and its covariance takes up kDoubt of what would be believed by the detection alone, by
/// discover(): Σ ← Σ + kDoubt (Σ_z + d dᵀ), d from the mean to there. Whichever is true, the next
/// detection finds its target within the gate: where it was, or where this one was. Until then no
/// belief counts that knows of nothing as new. False, track untouched, where the sensor cannot tell
/// where that is.
bool doubt(Track& track, const scenario::EstimatorSpec& spec, const models::SensorModel& sensor,
           const models::Viewpoint& from, const models::Measurement& measurement, Time time);

}  // namespace vantage::estimator
