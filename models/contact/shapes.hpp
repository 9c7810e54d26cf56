#pragma once

#include <Eigen/Core>

#include "models/world/world.hpp"

namespace vantage::models {

/// An axis-aligned box in space.
struct Box3 {
  Eigen::Vector3d min_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d max_m = Eigen::Vector3d::Zero();
};

Box3 box_of(const Obstacle& obstacle);

/// Returns the distance from a point to the surface of `box`; negative inside.
double signed_distance_m(const Box3& box, const Eigen::Vector3d& p_m);

/// Returns min over s in [0, 1] of signed_distance_m(box, a + s (b − a)), accurate to one nanometre
/// of position along the segment. The distance to a convex body is convex in s, so the search finds
/// the minimum.
double swept_distance_m(const Box3& box, const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m);

/// Returns the distance from a point inside the bounds to the nearest wall or the ceiling; negative
/// outside. The floor is excluded, because bodies may touch the floor.
double distance_to_bounds_m(const World& world, const Eigen::Vector3d& p_m);

}  // namespace vantage::models
