#pragma once

#include <optional>
#include <string_view>

#include <Eigen/Core>

#include "models/sensor/sensor.hpp"

// What one kind of sensor is. Everybody who measures, plans or estimates asks the law and never
// which kind it is.

namespace vantage::models {

/// The line from the sensor to the target.
struct SightLine {
  Eigen::Vector3d offset_world_m;  ///< z: true height difference, also for planar targets
  double horizontal_m;
  double range_m;  ///< horizontal for planar targets, in space for others
};

/// What a look tells of the place of a planar target, where that depends on nothing but the line of
/// sight u: M = along · u uᵀ + across / r² · u⊥ u⊥ᵀ + all_ways · I, along and across divided by
/// variance_growth().
struct PlanarLaw {
  double along_per_m2 = 0.0;
  double across_per_rad2 = 0.0;
  double all_ways_per_m2 = 0.0;
};

/// Distances from the sensor to a target, over every viewpoint of a disc, rounded outwards.
struct ReachedDistances {
  double horizontal_near_m;
  double horizontal_far_m;
  double range_near_m;  ///< not below range_min_m
  double drop_m;        ///< how much higher the sensor is; a planar target is on the ground
  int position_dim;
};

/// One kind of sensor. Functions are pure and allocate nothing; covariances of noise are diagonal.
struct SensorLaw {
  std::string_view name;  ///< in scenarios
  /// z is the calibrated range, the bearing (wrapped), or both in that order, and nothing else; a
  /// kind that measures anything besides has neither. A range has no direction at the sensor
  /// itself, a bearing none above or below it.
  bool measures_range = false;
  bool measures_bearing = false;
  /// z = H (target − sensor), H by the heading alone: a Kalman update is exact.
  bool is_linear = false;
  int (*measurement_dim)(int position_dim) = nullptr;
  /// Whether a target that is within range and field of view can be measured; null: it can.
  bool (*sees)(const SensorModel&, const Viewpoint&, const SightLine&) = nullptr;
  MeasurementVector (*observe)(const SensorModel&, const Viewpoint&, const SightLine&,
                               int position_dim) = nullptr;
  MeasurementJacobian (*jacobian)(const SensorModel&, const Viewpoint&, const SightLine&,
                                  int position_dim) = nullptr;
  /// Variances of z, row by row.
  MeasurementVector (*variances)(const SensorModel&, const Viewpoint&, const SightLine&,
                                 int position_dim) = nullptr;
  /// λ_max of the information over the disc, at most; +∞ where there is none.
  double (*information_bound)(const SensorModel&, const ReachedDistances&) = nullptr;
  /// See position_from(); null: it cannot tell.
  std::optional<PositionVector> (*position_from)(const SensorModel&, const Viewpoint&,
                                                 const MeasurementVector& z,
                                                 int position_dim) = nullptr;
  /// Null where information() depends on more than the line of sight: planners then ask
  /// information() itself, look by look, and bounds count the look in all directions.
  PlanarLaw (*planar_law)(const SensorModel&) = nullptr;
  /// For a sensor that measures the direction to a target alone and sees it from a least depth on:
  /// what a metre towards `bearing_rad` (from body x) and sine of elevation `up` has of depth;
  /// null: not such a sensor.
  double (*depth_per_m)(const SensorModel&, double bearing_rad, double cos_elevation,
                        double up) = nullptr;
};

/// Factor on range and bearing variances at `range_m`.
double variance_growth(const SensorModel& sensor, double range_m);
/// The field of view is a full turn.
bool sees_all_around(const SensorModel& sensor);
SightLine sight_line(const Viewpoint& from, const PositionVector& target_world_m);
/// From body x, wrapped.
double bearing_rad(const Viewpoint& from, const SightLine& to);

/// Nearer, ranges and bearings have no direction.
inline constexpr double kLeastRange_m = 1e-9;

}  // namespace vantage::models
