#pragma once

#include <optional>
#include <string_view>

#include <Eigen/Core>

#include "models/sensor/sensor.hpp"

// Interface of a sensor kind. Code that measures, plans or estimates uses the law and never
// branches on the kind.

namespace vantage::models {

/// Line of sight from the sensor to a target.
struct SightLine {
  Eigen::Vector3d offset_world_m;  ///< m; z: true height difference, also for planar targets
  double horizontal_m;
  double range_m;  ///< horizontal for planar targets, otherwise in space
};

/// Information of one measurement about a planar target's position, for kinds where it depends only
/// on the unit line of sight u: M = along · u uᵀ + across / r² · u⊥ u⊥ᵀ + all_ways · I. `along` and
/// `across` are divided by variance_growth().
struct PlanarLaw {
  double along_per_m2 = 0.0;
  double across_per_rad2 = 0.0;
  double all_ways_per_m2 = 0.0;
};

/// Range of distances from the sensor to a target over all viewpoints of a disc, rounded outwards.
struct ReachedDistances {
  double horizontal_near_m;
  double horizontal_far_m;
  double range_near_m;  ///< not below range_min_m
  double drop_m;        ///< height of the sensor above the target; a planar target is on the ground
  int position_dim;
};

/// One kind of sensor. The functions are pure and do not allocate; noise covariances are diagonal.
struct SensorLaw {
  std::string_view name;  ///< name in scenario files
  /// z is the calibrated range, the bearing (wrapped), or both in that order. Both flags are false
  /// for a kind that measures anything else in addition. A range is singular at the sensor itself,
  /// a bearing directly above or below it.
  bool measures_range = false;
  bool measures_bearing = false;
  /// True if z = H (target − sensor) and H depends on the heading alone: a Kalman update is exact.
  bool is_linear = false;
  int (*measurement_dim)(int position_dim) = nullptr;
  /// True if a target within range and field of view can be measured; null: it always can.
  bool (*sees)(const SensorModel&, const Viewpoint&, const SightLine&) = nullptr;
  MeasurementVector (*observe)(const SensorModel&, const Viewpoint&, const SightLine&,
                               int position_dim) = nullptr;
  MeasurementJacobian (*jacobian)(const SensorModel&, const Viewpoint&, const SightLine&,
                                  int position_dim) = nullptr;
  /// Returns the variances of z, one per row.
  MeasurementVector (*variances)(const SensorModel&, const Viewpoint&, const SightLine&,
                                 int position_dim) = nullptr;
  /// Returns an upper bound of λ_max of the information over the disc; +∞ if unbounded.
  double (*information_bound)(const SensorModel&, const ReachedDistances&) = nullptr;
  /// See position_from(); null if z does not determine the position.
  std::optional<PositionVector> (*position_from)(const SensorModel&, const Viewpoint&,
                                                 const MeasurementVector& z,
                                                 int position_dim) = nullptr;
  /// Null if information() depends on more than the line of sight. Planners then call information()
  /// for each measurement, and bounds count its information in all directions.
  PlanarLaw (*planar_law)(const SensorModel&) = nullptr;
  /// Returns the depth along the optical axis per metre of distance, in the direction of
  /// `bearing_rad` (from body x) and sine of elevation `up`. For sensors that measure only the
  /// direction to a target and need a minimum depth; null for other sensors.
  double (*depth_per_m)(const SensorModel&, double bearing_rad, double cos_elevation,
                        double up) = nullptr;
};

/// Returns the factor on range and bearing variances at `range_m`.
double variance_growth(const SensorModel& sensor, double range_m);
/// True if the field of view is a full turn.
bool sees_all_around(const SensorModel& sensor);
SightLine sight_line(const Viewpoint& from, const PositionVector& target_world_m);
/// Returns the bearing of the target from body x, rad, wrapped.
double bearing_rad(const Viewpoint& from, const SightLine& to);

/// Distance below which ranges and bearings are singular.
inline constexpr double kLeastRange_m = 1e-9;

}  // namespace vantage::models
