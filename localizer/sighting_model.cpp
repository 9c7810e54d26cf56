#include "localizer/sighting_model.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"

namespace vantage::localizer {

ExpectedSighting expected_sighting(const scenario::SightingSpec& spec, const Pose2& world_from_body,
                                   const Eigen::Vector2d& point_m) {
  constexpr double kDistanceMinM = 0.01;
  const double c = std::cos(world_from_body.yaw_rad);
  const double s = std::sin(world_from_body.yaw_rad);
  const Eigen::Vector2d heading(c, s);
  const Eigen::Vector2d v = point_m - world_from_body.position_m() - spec.forward_m * heading;
  const double d = std::max(v.norm(), kDistanceMinM);
  const double b = wrap_to_pi(std::atan2(v.y(), v.x()) - world_from_body.yaw_rad);

  // Derivatives of d and of the world-frame direction with respect to the vector v.
  const Eigen::RowVector2d d_by_v = v.transpose() / d;
  const Eigen::RowVector2d b_by_v = Eigen::RowVector2d(-v.y(), v.x()) / (d * d);
  const double off = spec.range_is_depth ? b - spec.axis_rad : 0.0;
  const double along = std::cos(off);
  const double by_bearing = -spec.range_scale * d * std::sin(off);

  ExpectedSighting expected;
  expected.distance_m = d;
  expected.range_m = spec.range_scale * d * along + spec.range_offset_m;
  expected.bearing_rad = wrap_to_pi(b + spec.bearing_offset_rad);
  expected.by_point.row(0) = spec.range_scale * along * d_by_v + by_bearing * b_by_v;
  expected.by_point.row(1) = b_by_v;
  expected.by_pose.leftCols<2>() = -expected.by_point;
  // The sensor moves with the yaw by forward · (−s, c), and the bearing decreases by the yaw.
  const Eigen::Vector2d sensor_by_yaw = spec.forward_m * Eigen::Vector2d(-s, c);
  expected.by_pose.col(2) = -expected.by_point * sensor_by_yaw;
  expected.by_pose(0, 2) -= by_bearing;
  expected.by_pose(1, 2) -= 1.0;
  return expected;
}

Eigen::Matrix2d sighting_covariance(const scenario::SightingNoiseSpec& noise,
                                    const ExpectedSighting& expected, bool is_mate) {
  const double d = expected.distance_m;
  const double range_sigma_m = noise.range_sigma_m + noise.range_sigma_per_m * d * d;
  Eigen::Matrix2d R = Eigen::Matrix2d::Zero();
  R(0, 0) = range_sigma_m * range_sigma_m;
  R(1, 1) = noise.bearing_sigma_rad * noise.bearing_sigma_rad +
            noise.across_sigma_m * noise.across_sigma_m / (d * d);
  if (is_mate) {
    R += noise.teammate_sigma_m * noise.teammate_sigma_m * expected.by_point *
         expected.by_point.transpose();
  }
  return R;
}

Eigen::Vector2d sighted_point_m(const scenario::SightingSpec& spec, double range_m,
                                double bearing_rad) {
  // lower limit of the cosine: a depth does not determine the distance across the axis
  constexpr double kAlongMin = 0.1;
  const double b = bearing_rad - spec.bearing_offset_rad;
  const double along = spec.range_is_depth ? std::max(std::cos(b - spec.axis_rad), kAlongMin) : 1.0;
  const double d = std::max((range_m - spec.range_offset_m) / (spec.range_scale * along), 0.0);
  return {spec.forward_m + d * std::cos(b), d * std::sin(b)};
}

}  // namespace vantage::localizer
