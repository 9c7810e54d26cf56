#pragma once

#include <Eigen/Core>

#include "core/pose.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::localizer {

/// Expected sighting of a point, and its derivatives.
struct ExpectedSighting {
  double range_m = 0.0;      ///< range reported by the sensor
  double bearing_rad = 0.0;  ///< bearing as reported, from the body's x axis
  double distance_m = 0.0;   ///< true distance from the sensor
  Eigen::Matrix<double, 2, 3>
      by_pose;  ///< derivatives of (range, bearing) with respect to (x, y, yaw)
  Eigen::Matrix<double, 2, 2>
      by_point;  ///< derivatives of (range, bearing) with respect to the point
};

/// Returns the sighting of `point_m` from a robot at `world_from_body`. The distance to the sensor
/// is assumed to be at least 1 cm.
///
/// With d and b the true distance and bearing from the sensor, the bearing is b + offset, and the
/// range is scale · d + offset, or scale · d · cos(b − axis) + offset if the range is a depth.
ExpectedSighting expected_sighting(const scenario::SightingSpec& spec, const Pose2& world_from_body,
                                   const Eigen::Vector2d& point_m);

/// Returns the covariance of (range, bearing) of a sighting without the bearing error that all
/// sightings of its frame share.
/// @param is_mate  true: the sighted body is a teammate, whose sighted point varies
Eigen::Matrix2d sighting_covariance(const scenario::SightingNoiseSpec& noise,
                                    const ExpectedSighting& expected, bool is_mate);

/// Returns the point in the body frame at which a body was reported with `range_m` and
/// `bearing_rad`: the inverse of expected_sighting().
Eigen::Vector2d sighted_point_m(const scenario::SightingSpec& spec, double range_m,
                                double bearing_rad);

}  // namespace vantage::localizer
