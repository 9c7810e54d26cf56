#include <algorithm>
#include <cmath>
#include <limits>

#include "models/sensor/kinds/kinds.hpp"

// Measures image coordinates, pixels. Camera frame: x right, y down, z along the optical axis,
// which is tilted down from body x.

namespace vantage::models::sensor_kinds {
namespace {

// Returns the rotation from the level body frame to the camera frame.
Eigen::Matrix3d camera_from_body(double tilt_rad) {
  const double c = std::cos(tilt_rad);
  const double s = std::sin(tilt_rad);
  Eigen::Matrix3d R;
  R << 0.0, -1.0, 0.0,  //
      -s, 0.0, -c,      //
      c, 0.0, -s;
  return R;
}

Eigen::Matrix3d camera_from_world(const SensorModel& sensor, const Viewpoint& from) {
  return camera_from_body(sensor.camera_tilt_rad) * body_from_world(from);
}

bool can_measure(const SensorModel& sensor, const Viewpoint& from, const SightLine& to) {
  const Eigen::Vector3d q = camera_from_world(sensor, from) * to.offset_world_m;
  const double depth_m = q.z();
  return depth_m > 0.0 && depth_m >= sensor.depth_min_m;
}

MeasurementVector observe(const SensorModel& sensor, const Viewpoint& from, const SightLine& to,
                          int /*position_dim*/) {
  const Eigen::Vector3d q = camera_from_world(sensor, from) * to.offset_world_m;
  return sensor.focal_length_pixels / q.z() * q.head<2>();
}

MeasurementJacobian jacobian(const SensorModel& sensor, const Viewpoint& from, const SightLine& to,
                             int position_dim) {
  const Eigen::Matrix3d R = camera_from_world(sensor, from);
  const Eigen::Vector3d q = R * to.offset_world_m;
  Eigen::Matrix<double, 2, 3> projection;                  // π'(q)
  projection << 1.0 / q.z(), 0.0, -q.x() / square(q.z()),  //
      0.0, 1.0 / q.z(), -q.y() / square(q.z());
  const Eigen::Matrix<double, 2, 3> H_space = sensor.focal_length_pixels * projection * R;
  return H_space.leftCols(position_dim);
}

MeasurementVector variances(const SensorModel& sensor, const Viewpoint& /*from*/,
                            const SightLine& /*to*/, int /*position_dim*/) {
  return Eigen::Vector2d::Constant(square(sensor.pixel_sigma));
}

// Returns the information bound. Source: dissertation, eq. 2.30 and the next, with d_min; the
// second bound is not from there.
double bound(const SensorModel& sensor, const ReachedDistances& reached) {
  const bool in_space = reached.position_dim == 3;
  const double drop_m = reached.drop_m;
  const double horizontal_max_m =
      in_space ? std::sqrt(square(sensor.range_max_m) - square(drop_m)) : sensor.range_max_m;
  const double nearest_m = reached.horizontal_near_m;
  const double farthest_m = std::min(reached.horizontal_far_m, horizontal_max_m);
  const double c = std::cos(sensor.camera_tilt_rad);
  const double s = std::sin(sensor.camera_tilt_rad);
  // depth = c ρ cos β + s · drop is bilinear in ρ and cos β: its extrema are at the corners of
  // their ranges.
  const double least_cos = has_full_view(sensor) ? -1.0 : std::cos(0.5 * sensor.fov_rad);
  double depth_min_m = std::numeric_limits<double>::infinity();
  double depth_max_m = -depth_min_m;
  for (const double rho_m : {nearest_m, farthest_m}) {
    for (const double cos_bearing : {least_cos, 1.0}) {
      const double depth_m = c * rho_m * cos_bearing + s * drop_m;
      depth_min_m = std::min(depth_min_m, depth_m);
      depth_max_m = std::max(depth_max_m, depth_m);
    }
  }
  if (depth_max_m + kLeastRange_m < sensor.depth_min_m) {
    return 0.0;
  }
  const double depth_m = std::max(sensor.depth_min_m, depth_min_m - kLeastRange_m);
  if (depth_m <= 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  const double distance2_m2 = square(farthest_m) + square(drop_m);
  double gain = distance2_m2 / square(square(depth_m));
  if (!in_space) {
    // Planar motion changes the depth by at most |c|: ‖P v‖ ≤ 1/d + ‖q_⊥‖ |c| / d². This bound
    // is exact for a camera that points straight down; the spatial bound is then (‖q‖/d)² times
    // too large.
    const double across_m = std::sqrt(std::max(0.0, distance2_m2 - square(depth_m)));
    gain = std::min(gain, square((1.0 + across_m * std::abs(c) / depth_m) / depth_m));
  }
  return square(sensor.focal_length_pixels / sensor.pixel_sigma) * gain;
}

std::optional<PositionVector> position_from(const SensorModel& sensor, const Viewpoint& from,
                                            const MeasurementVector& z, int position_dim) {
  const double f = sensor.focal_length_pixels;
  const Eigen::Vector3d ray_world =
      camera_from_world(sensor, from).transpose() * Eigen::Vector3d(z(0) / f, z(1) / f, 1.0);
  const double depth_m = -from.height_m / ray_world.z();
  if (!(depth_m > 0.0) || !std::isfinite(depth_m)) {
    return std::nullopt;
  }
  PositionVector target_world_m = PositionVector::Zero(position_dim);
  target_world_m.head<2>() = from.world_from_body.position_m() + depth_m * ray_world.head<2>();
  return target_world_m;
}

double depth_per_m(const SensorModel& sensor, double bearing_rad, double cos_elevation, double up) {
  return std::cos(sensor.camera_tilt_rad) * cos_elevation * std::cos(bearing_rad) -
         std::sin(sensor.camera_tilt_rad) * up;
}

}  // namespace

constinit const SensorLaw camera = [] {
  SensorLaw law = law_of("camera", two_rows, observe, jacobian, variances, bound);
  law.can_measure = can_measure;
  law.position_from = position_from;
  law.depth_per_m = depth_per_m;
  return law;
}();

}  // namespace vantage::models::sensor_kinds
