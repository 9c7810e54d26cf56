#pragma once

#include <optional>
#include <span>
#include <string_view>

#include <Eigen/Core>

#include "models/sensor/sensor.hpp"

// The measurement model of a sensor kind (SensorLaw). Simulator, planner and estimator use only
// this model and never test for a specific kind.

namespace vantage::models {

/// Line of sight from the sensor to a target.
struct SightLine {
  Eigen::Vector3d offset_world_m;  ///< z: true height difference, even for planar targets
  double horizontal_m;
  double range_m;  ///< horizontal distance for planar targets, otherwise distance in space
  /// Velocity of the target, m/s; zero if its state has none.
  Eigen::Vector2d velocity_world_mps = Eigen::Vector2d::Zero();
};

/// Allowed values of a sensor's parameter.
enum class ParameterRule { kAny, kAtLeastZero, kAboveZero };

/// A parameter of one kind of sensor. Scenarios, planning problems and Python read it under its
/// name. Values are stored in SensorModel; read them with own_parameter().
struct SensorParameter {
  std::string_view name;  ///< name with the unit at its end: "range_rate_sigma_mps"
  std::string_view unit;  ///< "m/s"
  double initial;         ///< default value
  ParameterRule rule;
  std::string_view purpose;  ///< one phrase for help texts
};

/// Position information of a planar target if M depends only on the unit line of sight u: M = along
/// · u uᵀ + across / r² · u⊥ u⊥ᵀ + isotropic · I. The caller divides `along` and `across` by
/// variance_growth().
struct PlanarLaw {
  double along_per_m2 = 0.0;
  double across_per_rad2 = 0.0;
  double isotropic_per_m2 = 0.0;
};

/// Distances from the sensor to a target over all viewpoints in a disc, rounded outwards.
struct ReachedDistances {
  double horizontal_near_m;
  double horizontal_far_m;
  double range_near_m;  ///< smallest range, ≥ range_min_m
  double drop_m;        ///< height of the sensor above the target; a planar target is on the ground
  int position_dim;
  std::optional<double> speed_mps;  ///< largest speed; nullopt: the target's state has no velocity
};

/// One kind of sensor. Functions are pure and do not allocate; noise covariances are diagonal.
///
/// z may depend on the target's velocity (SightLine::velocity_world_mps) if `velocity_jacobian` is
/// set. The sensor's own velocity is not an argument: such a kind reports the motion of the target
/// relative to the ground.
struct SensorLaw {
  std::string_view name;  ///< name in scenarios
  /// The parameters that only this kind has, at most kMaxOwnParameters.
  std::span<const SensorParameter> parameters = {};
  /// Parts of z: the calibrated range, the wrapped bearing, or both in this order. Rows that depend
  /// on the velocity may follow a range. measures_range and measures_bearing are false for a kind
  /// that measures anything else. A range has no direction if the target is at the sensor itself; a
  /// bearing has none if the target is directly above or below the sensor.
  bool measures_range = false;
  bool measures_bearing = false;
  /// True if z = H (target − sensor), where H depends only on the heading. A Kalman update is then
  /// exact.
  bool is_linear = false;
  int (*measurement_dim)(int position_dim) = nullptr;
  /// True if a target within range and field of view can be measured; null: always.
  bool (*can_measure)(const SensorModel&, const Viewpoint&, const SightLine&) = nullptr;
  MeasurementVector (*observe)(const SensorModel&, const Viewpoint&, const SightLine&,
                               int position_dim) = nullptr;
  MeasurementJacobian (*jacobian)(const SensorModel&, const Viewpoint&, const SightLine&,
                                  int position_dim) = nullptr;
  /// Returns ∂z/∂velocity, measurement_dim × 2, for a target whose state has a velocity; null: z
  /// does not depend on the velocity.
  MeasurementJacobian (*velocity_jacobian)(const SensorModel&, const Viewpoint&,
                                           const SightLine&) = nullptr;
  /// Returns the variances of z, row by row.
  MeasurementVector (*variances)(const SensorModel&, const Viewpoint&, const SightLine&,
                                 int position_dim) = nullptr;
  /// Returns an upper bound of λ_max of the information over the disc; +∞ where it is unbounded.
  /// With a speed, the bound is for information about the state (position, velocity), otherwise
  /// about the position.
  double (*information_bound)(const SensorModel&, const ReachedDistances&) = nullptr;
  /// See position_from(); null: z does not determine the position.
  std::optional<PositionVector> (*position_from)(const SensorModel&, const Viewpoint&,
                                                 const MeasurementVector& z,
                                                 int position_dim) = nullptr;
  /// Null if the kind measures velocity, or if information() depends on more than the line of
  /// sight. Planners then call information() for each measurement, and bounds assume that its
  /// information applies in all directions.
  PlanarLaw (*planar_law)(const SensorModel&) = nullptr;
  /// For sensors that only measure the direction to a target and need a minimum depth. Returns the
  /// depth per metre of distance, in the direction `bearing_rad` from body x. `up` is the sine of
  /// the elevation. Null for other sensors.
  double (*depth_per_m)(const SensorModel&, double bearing_rad, double cos_elevation,
                        double up) = nullptr;
};

/// Returns the factor by which range and bearing variances are multiplied at `range_m`.
double variance_growth(const SensorModel& sensor, double range_m);
/// True if the field of view is a full circle.
bool has_full_view(const SensorModel& sensor);
SightLine sight_line(const Viewpoint& from, const PositionVector& target_world_m);
/// Returns the value of law().parameters[i], or its default if `sensor` does not set it.
double own_parameter(const SensorModel& sensor, int i);
/// Returns the index of the own parameter `name` of the kind; nullopt if the kind has none.
std::optional<int> find_parameter(SensorKind kind, std::string_view name);
/// Returns the rule in words, such as "above 0".
std::string_view words_of(ParameterRule rule);
/// True if `rule` allows `value`; false if the value is not finite.
bool is_allowed(ParameterRule rule, double value);
/// Returns the first parameter of `sensor` whose value breaks its rule; null if there is none.
const SensorParameter* broken_parameter(const SensorModel& sensor);
/// Returns the bearing from body x, wrapped, rad.
double bearing_rad(const Viewpoint& from, const SightLine& to);

/// Minimum distance at which ranges and bearings have a direction, m.
inline constexpr double kLeastRange_m = 1e-9;

}  // namespace vantage::models
