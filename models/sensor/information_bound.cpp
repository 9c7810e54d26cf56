#include <algorithm>
#include <cmath>
#include <limits>

#include "models/sensor/sensor.hpp"
#include "models/sensor/sight.hpp"

namespace vantage::models {
namespace {

using sensor_detail::kLeastRange_m;
using sensor_detail::sees_all_around;
using sensor_detail::Sight;
using sensor_detail::sight;
using sensor_detail::square;
using sensor_detail::variance_growth;

// Source: dissertation 2.30 f. with d_min; the second bound is ours.
double camera_bound(const SensorModel& sensor, double height_m, double nearest_m, double farthest_m,
                    const PositionVector& target_world_m) {
  const bool in_space = target_world_m.rows() == 3;
  const double drop_m = height_m - (in_space ? target_world_m(2) : 0.0);
  const double c = std::cos(sensor.camera_tilt_rad);
  const double s = std::sin(sensor.camera_tilt_rad);
  // depth = c ρ cos β + s · drop is bilinear in ρ and cos β: extreme at the corners of their box.
  const double least_cos = sees_all_around(sensor) ? -1.0 : std::cos(0.5 * sensor.fov_rad);
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
    // Moves in the plane change depth by |c| at most: ‖P v‖ ≤ 1/d + ‖q_⊥‖ |c| / d². Exact for a
    // camera that looks straight down, where the other bound is (‖q‖/d)² times too large.
    const double across_m = std::sqrt(std::max(0.0, distance2_m2 - square(depth_m)));
    gain = std::min(gain, square((1.0 + across_m * std::abs(c) / depth_m) / depth_m));
  }
  return square(sensor.focal_length_pixels / sensor.pixel_sigma) * gain;
}

}  // namespace

double information_bound(const SensorModel& sensor, const Viewpoint& from, double reach_m,
                         const PositionVector& target_world_m) {
  const Sight to = sight(from, target_world_m);
  const bool in_space = target_world_m.rows() == 3;
  const double dz_m = in_space ? to.offset_world_m.z() : 0.0;
  // Horizontal distances that the disc offers, rounded outwards.
  const double nearest_m = std::max(0.0, to.horizontal_m - reach_m - kLeastRange_m);
  const double farthest_m = to.horizontal_m + reach_m + kLeastRange_m;
  const double range_near_m = std::max(sensor.range_min_m, std::hypot(nearest_m, dz_m));
  if (range_near_m >= sensor.range_max_m || std::hypot(farthest_m, dz_m) < sensor.range_min_m) {
    return 0.0;
  }
  const double growth = variance_growth(sensor, range_near_m);
  const double range_information =
      square(sensor.calibration.range_scale / sensor.range_sigma_m) / growth;
  switch (sensor.kind) {
    case SensorKind::kPosition:
      return 1.0 / square(sensor.position_sigma_m);
    case SensorKind::kRange:
      return range_information;
    case SensorKind::kBearing:
    case SensorKind::kRangeBearing: {
      const double rho_m = std::max(sensor.range_min_m, nearest_m);
      if (farthest_m < sensor.range_min_m) {
        return 0.0;
      }
      // 1 / 0 is the +∞ that a bearing sensor without a least range deserves.
      const double bearing_information =
          rho_m > 0.0 ? 1.0 / (square(sensor.bearing_sigma_rad * rho_m) * growth)
                      : std::numeric_limits<double>::infinity();
      // Range and bearing inform about orthogonal directions: the larger one is λ_max.
      return sensor.kind == SensorKind::kBearing ? bearing_information
                                                 : std::max(range_information, bearing_information);
    }
    case SensorKind::kCamera: {
      const double horizontal_max_m =
          in_space ? std::sqrt(square(sensor.range_max_m) - square(dz_m)) : sensor.range_max_m;
      return camera_bound(sensor, from.height_m, nearest_m, std::min(farthest_m, horizontal_max_m),
                          target_world_m);
    }
  }
  return 0.0;
}

}  // namespace vantage::models
