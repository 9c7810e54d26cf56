#include "models/world/world.hpp"

#include <algorithm>
#include <cmath>

#include "models/world/border.hpp"

namespace vantage::models {
namespace {

// Returns the signed distance to the border of `box`: negative inside.
double signed_distance_m(const Rectangle& box, const Eigen::Vector2d& p_m) {
  return border_distance_m(std::max(box.min_m.x() - p_m.x(), p_m.x() - box.max_m.x()),
                           std::max(box.min_m.y() - p_m.y(), p_m.y() - box.max_m.y()));
}

double cross(const Eigen::Vector2d& u, const Eigen::Vector2d& v) {
  return u.x() * v.y() - u.y() * v.x();
}

// Tests the separating axes of a closed segment and an open rectangle: x, y and the segment's
// normal. No division is used, so a segment along an edge or through a corner is decided exactly.
bool crosses_interior(const Rectangle& box, const Eigen::Vector2d& a_m,
                      const Eigen::Vector2d& b_m) {
  if (std::max(a_m.x(), b_m.x()) <= box.min_m.x() || std::min(a_m.x(), b_m.x()) >= box.max_m.x() ||
      std::max(a_m.y(), b_m.y()) <= box.min_m.y() || std::min(a_m.y(), b_m.y()) >= box.max_m.y()) {
    return false;
  }
  const Eigen::Vector2d d = b_m - a_m;
  if (d.x() == 0.0 || d.y() == 0.0) {
    return true;  // the segment is a point or parallel to x or y, so both axes are sufficient
  }
  const double s00 = cross(d, box.min_m - a_m);
  const double s11 = cross(d, box.max_m - a_m);
  const double s01 = cross(d, Eigen::Vector2d(box.min_m.x(), box.max_m.y()) - a_m);
  const double s10 = cross(d, Eigen::Vector2d(box.max_m.x(), box.min_m.y()) - a_m);
  return std::min({s00, s01, s10, s11}) < 0.0 && std::max({s00, s01, s10, s11}) > 0.0;
}

double point_segment_distance_m(const Eigen::Vector2d& p_m, const Eigen::Vector2d& a_m,
                                const Eigen::Vector2d& b_m) {
  const Eigen::Vector2d d = b_m - a_m;
  const double length2 = d.squaredNorm();
  const double s = length2 > 0.0 ? std::clamp((p_m - a_m).dot(d) / length2, 0.0, 1.0) : 0.0;
  return (a_m + s * d - p_m).norm();
}

// The smallest distance between disjoint convex polygons is at a corner of one polygon.
double segment_distance_m(const Rectangle& box, const Eigen::Vector2d& a_m,
                          const Eigen::Vector2d& b_m) {
  const double ends = std::min(signed_distance_m(box, a_m), signed_distance_m(box, b_m));
  if (ends <= 0.0 || crosses_interior(box, a_m, b_m)) {
    return std::min(ends, 0.0);
  }
  return std::min({ends, point_segment_distance_m(box.min_m, a_m, b_m),
                   point_segment_distance_m(box.max_m, a_m, b_m),
                   point_segment_distance_m({box.min_m.x(), box.max_m.y()}, a_m, b_m),
                   point_segment_distance_m({box.max_m.x(), box.min_m.y()}, a_m, b_m)});
}

}  // namespace

bool Rectangle::contains(const Eigen::Vector2d& p_m) const {
  return p_m.x() >= min_m.x() && p_m.x() <= max_m.x() && p_m.y() >= min_m.y() &&
         p_m.y() <= max_m.y();
}

double clearance_m(const World& world, const Eigen::Vector2d& p_m) {
  double clearance = -signed_distance_m(world.bounds, p_m);
  for (const Obstacle& obstacle : world.obstacles) {
    const Rectangle& box = obstacle.footprint;
    const double apart_m = std::max(std::max(box.min_m.x() - p_m.x(), p_m.x() - box.max_m.x()),
                                    std::max(box.min_m.y() - p_m.y(), p_m.y() - box.max_m.y()));
    if (apart_m < clearance) {  // a lower bound of the distance, so most boxes need no square root
      clearance = std::min(clearance, signed_distance_m(box, p_m));
    }
  }
  return clearance;
}

NearbyObstacles nearby_obstacles(const World& world, const Eigen::Vector2d& p_m, double reach_m) {
  NearbyObstacles nearby;
  for (std::size_t i = 0; i < world.obstacles.size(); ++i) {
    const Rectangle& box = world.obstacles[i].footprint;
    if ((box.min_m - p_m).maxCoeff() < reach_m && (p_m - box.max_m).maxCoeff() < reach_m) {
      if (nearby.count == NearbyObstacles::kMax) {
        nearby.is_complete = false;
        break;
      }
      nearby.indices[nearby.count++] = static_cast<std::uint32_t>(i);
    }
  }
  return nearby;
}

double clearance_m(const World& world, const NearbyObstacles& nearby, const Eigen::Vector2d& p_m) {
  if (!nearby.is_complete) {
    return clearance_m(world, p_m);
  }
  double clearance = -signed_distance_m(world.bounds, p_m);
  for (std::size_t i = 0; i < nearby.count; ++i) {
    clearance =
        std::min(clearance, signed_distance_m(world.obstacles[nearby.indices[i]].footprint, p_m));
  }
  return clearance;
}

bool line_of_sight(const World& world, const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) {
  return std::none_of(
      world.obstacles.begin(), world.obstacles.end(),
      [&](const Obstacle& obstacle) { return crosses_interior(obstacle.footprint, a_m, b_m); });
}

double region_cost(const World& world, const Eigen::Vector2d& p_m) {
  double cost = 0.0;
  for (const Region& region : world.regions) {
    if (region.footprint.contains(p_m)) {
      cost += region.cost_per_step;
    }
  }
  return cost;
}

double closest_approach_m(const Eigen::Vector3d& a0_m, const Eigen::Vector3d& a1_m,
                          const Eigen::Vector3d& b0_m, const Eigen::Vector3d& b1_m) {
  const Eigen::Vector3d offset = a0_m - b0_m;
  const Eigen::Vector3d motion = (a1_m - a0_m) - (b1_m - b0_m);
  const double motion2 = motion.squaredNorm();
  const double s = motion2 > 0.0 ? std::clamp(-offset.dot(motion) / motion2, 0.0, 1.0) : 0.0;
  return (offset + s * motion).norm();
}

double swept_clearance_m(const World& world, const Eigen::Vector2d& a_m,
                         const Eigen::Vector2d& b_m) {
  // The bounds are convex, so the point nearest to the walls is an end of the segment.
  double clearance =
      -std::max(signed_distance_m(world.bounds, a_m), signed_distance_m(world.bounds, b_m));
  const Eigen::Vector2d low_m = a_m.cwiseMin(b_m);
  const Eigen::Vector2d high_m = a_m.cwiseMax(b_m);
  for (const Obstacle& obstacle : world.obstacles) {
    const Rectangle& box = obstacle.footprint;
    const double apart_m =
        std::max((box.min_m - high_m).maxCoeff(), (low_m - box.max_m).maxCoeff());
    if (apart_m < clearance) {  // lower bound, as in clearance_m()
      clearance = std::min(clearance, segment_distance_m(box, a_m, b_m));
    }
  }
  return clearance;
}

}  // namespace vantage::models
