#include "models/mapping/beam_scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace vantage::models {
namespace {

// Interval of the ray inside the rectangle; empty if begin > end.
struct Stretch {
  double begin_m = -std::numeric_limits<double>::infinity();
  double end_m = std::numeric_limits<double>::infinity();
};

Stretch inside(const Rectangle& box, const Eigen::Vector2d& from_m,
               const Eigen::Vector2d& direction) {
  Stretch stretch;
  for (int axis = 0; axis < 2; ++axis) {
    if (std::abs(direction[axis]) < 1e-12) {
      if (from_m[axis] < box.min_m[axis] || from_m[axis] > box.max_m[axis]) {
        return {1.0, 0.0};
      }
      continue;
    }
    double near_m = (box.min_m[axis] - from_m[axis]) / direction[axis];
    double far_m = (box.max_m[axis] - from_m[axis]) / direction[axis];
    if (near_m > far_m) {
      std::swap(near_m, far_m);
    }
    stretch.begin_m = std::max(stretch.begin_m, near_m);
    stretch.end_m = std::min(stretch.end_m, far_m);
  }
  return stretch;
}

}  // namespace

double ray_distance_m(const World& world, const Eigen::Vector2d& from_m, double bearing_rad) {
  const Eigen::Vector2d direction(std::cos(bearing_rad), std::sin(bearing_rad));
  if (!world.bounds.contains(from_m)) {
    return 0.0;
  }
  double distance_m = inside(world.bounds, from_m, direction).end_m;
  for (const Obstacle& obstacle : world.obstacles) {
    const Stretch stretch = inside(obstacle.footprint, from_m, direction);
    if (stretch.begin_m <= stretch.end_m && stretch.end_m >= 0.0) {
      distance_m = std::min(distance_m, std::max(0.0, stretch.begin_m));
    }
  }
  return std::max(0.0, distance_m);
}

std::vector<double> beam_scan(const World& world, const BeamSensor& sensor,
                              const Pose2& world_from_body, std::mt19937_64& random) {
  std::normal_distribution<double> noise_m(0.0, sensor.sigma_m);
  std::vector<double> ranges_m;
  ranges_m.reserve(static_cast<std::size_t>(sensor.beams));
  for (int beam = 0; beam < sensor.beams; ++beam) {
    const double distance_m = ray_distance_m(world, world_from_body.position_m(),
                                             world_from_body.yaw_rad + sensor.bearing_rad(beam));
    ranges_m.push_back(sensor.mean_range_m(distance_m) + noise_m(random));
  }
  return ranges_m;
}

}  // namespace vantage::models
