#pragma once

#include <algorithm>
#include <cmath>

#include "models/sensor/sensor.hpp"

// What the two halves of the sensor model share: sensor.cpp and information_bound.cpp.

namespace vantage::models::sensor_detail {

inline constexpr double kLeastRange_m = 1e-9;       // nearer, ranges and bearings have no direction
inline constexpr double kFullTurnSlack_rad = 1e-9;  // 360° given in degrees may round below 2π

inline bool has_range(SensorKind kind) {
  return kind == SensorKind::kRange || kind == SensorKind::kRangeBearing;
}
inline bool has_bearing(SensorKind kind) {
  return kind == SensorKind::kBearing || kind == SensorKind::kRangeBearing;
}

inline double square(double x) { return x * x; }

// The line from the sensor to the target.
struct Sight {
  Eigen::Vector3d offset_world_m;  // z: true height difference, also for planar targets
  double horizontal_m;
  double range_m;  // horizontal for planar targets, in space for others
};

inline Sight sight(const Viewpoint& from, const PositionVector& target_world_m) {
  const bool in_space = target_world_m.rows() == 3;
  const Eigen::Vector2d d = target_world_m.head<2>() - from.world_from_body.position_m();
  const double dz = (in_space ? target_world_m(2) : 0.0) - from.height_m;
  const double horizontal_m = d.norm();
  return {{d.x(), d.y(), dz}, horizontal_m, in_space ? std::hypot(horizontal_m, dz) : horizontal_m};
}

// From body x, wrapped.
inline double bearing_rad(const Viewpoint& from, const Sight& to) {
  return wrap_to_pi(std::atan2(to.offset_world_m.y(), to.offset_world_m.x()) -
                    from.world_from_body.yaw_rad);
}

// Factor on range and bearing variances at `range_m`.
inline double variance_growth(const SensorModel& sensor, double range_m) {
  return sensor.variance_grows_with_range
             ? std::max(sensor.variance_floor, range_m / sensor.range_max_m)
             : 1.0;
}

inline bool sees_all_around(const SensorModel& sensor) {
  return sensor.fov_rad >= 2.0 * kPi - kFullTurnSlack_rad;
}

}  // namespace vantage::models::sensor_detail
