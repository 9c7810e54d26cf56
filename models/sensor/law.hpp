#pragma once

#include <optional>
#include <string_view>

#include <Eigen/Core>

#include "models/sensor/sensor.hpp"

// The law of a sensor kind: its measurement model. Simulator, planner and estimator use the law
// only and never test for a specific kind.

namespace vantage::models {

/// Line of sight from the sensor to a target.
struct SightLine {
  Eigen::Vector3d offset_world_m;  ///< z: true height difference, even for planar targets
  double horizontal_m;
  double range_m;  ///< horizontal distance for planar targets, otherwise distance in space
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
};

/// One kind of sensor. Functions are pure and do not allocate; noise covariances are diagonal.
struct SensorLaw {
  std::string_view name;  ///< name in scenarios
  /// z is the calibrated range, the wrapped bearing, or both in this order. Both flags are false
  /// for a kind that measures anything else. A range has no direction if the target is at the
  /// sensor itself; a bearing has none if the target is directly above or below the sensor.
  bool measures_range = false;
  bool measures_bearing = false;
  /// z = H (target − sensor), where H only depends on the heading: a Kalman update is exact.
  bool is_linear = false;
  int (*measurement_dim)(int position_dim) = nullptr;
  /// True if a target within range and field of view can be measured; null: always.
  bool (*can_measure)(const SensorModel&, const Viewpoint&, const SightLine&) = nullptr;
  MeasurementVector (*observe)(const SensorModel&, const Viewpoint&, const SightLine&,
                               int position_dim) = nullptr;
  MeasurementJacobian (*jacobian)(const SensorModel&, const Viewpoint&, const SightLine&,
                                  int position_dim) = nullptr;
  /// Returns the variances of z, row by row.
  MeasurementVector (*variances)(const SensorModel&, const Viewpoint&, const SightLine&,
                                 int position_dim) = nullptr;
  /// Returns an upper bound of λ_max of the information over the disc; +∞ where it is unbounded.
  double (*information_bound)(const SensorModel&, const ReachedDistances&) = nullptr;
  /// See position_from(); null: z does not determine the position.
  std::optional<PositionVector> (*position_from)(const SensorModel&, const Viewpoint&,
                                                 const MeasurementVector& z,
                                                 int position_dim) = nullptr;
  /// Null if information() depends on more than the line of sight. Planners then call information()
  /// for each measurement, and bounds count its information in all directions.
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
/// Returns the bearing from body x, wrapped, rad.
double bearing_rad(const Viewpoint& from, const SightLine& to);

/// Minimum distance at which ranges and bearings have a direction, m.
inline constexpr double kLeastRange_m = 1e-9;

}  // namespace vantage::models
