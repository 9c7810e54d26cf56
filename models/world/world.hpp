#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace vantage::models {

/// Axis-aligned rectangle in the plane.
struct Rectangle {
  Eigen::Vector2d min_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d max_m = Eigen::Vector2d::Zero();
  [[nodiscard]] bool contains(const Eigen::Vector2d& p_m) const;
};

/// Upright box on the ground; blocks motion and line of sight.
struct Obstacle {
  Rectangle footprint;
  double height_m = 10.0;
};

/// Part of the ground with an additional cost per step (mud for wheels, wind for wings).
struct Region {
  std::string name;
  Rectangle footprint;
  double cost_per_step = 0.0;
};

/// Environment: a rectangle with boxes in it.
struct World {
  Rectangle bounds;
  double ceiling_m = 10.0;
  std::vector<Obstacle> obstacles;
  std::vector<Region> regions;
};

/// Returns the exact distance from `p_m` to the nearest obstacle or wall, m; negative inside an
/// obstacle or outside the bounds. Obstacles count whatever their height.
double clearance_m(const World& world, const Eigen::Vector2d& p_m);

/// Indices of the obstacles that matter around one point.
struct NearbyObstacles {
  static constexpr std::size_t kMax = 16;
  std::size_t count = 0;
  bool is_complete = true;  ///< false: there were more than kMax; the list must not be used
  std::uint32_t indices[kMax] = {};
};
/// Returns the obstacles whose bounding boxes are within `reach_m` of `p_m`. At a point within d of
/// `p_m`, the other obstacles do not affect a clearance below reach_m − d.
NearbyObstacles nearby_obstacles(const World& world, const Eigen::Vector2d& p_m, double reach_m);
/// Returns the clearance to the obstacles of `nearby` and the walls, m; to all obstacles if
/// `nearby` is incomplete.
double clearance_m(const World& world, const NearbyObstacles& nearby, const Eigen::Vector2d& p_m);

/// True if the closed segment from `a_m` to `b_m` avoids the interior of every obstacle.
bool line_of_sight(const World& world, const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m);

/// Returns the sum of cost_per_step over the regions that contain `p_m`.
double region_cost(const World& world, const Eigen::Vector2d& p_m);

/// Returns the exact minimum distance between two points that move linearly over the same unit of
/// time: min over s in [0, 1] of ‖(a0 − b0) + s ((a1 − a0) − (b1 − b0))‖, m. Closed form, so it
/// detects approaches that sampling would miss.
double closest_approach_m(const Eigen::Vector3d& a0_m, const Eigen::Vector3d& a1_m,
                          const Eigen::Vector3d& b0_m, const Eigen::Vector3d& b1_m);

/// Returns the exact distance from the segment a–b to the nearest obstacle or wall, m; ≤ 0 if it
/// touches one. A disc of radius r moves clear along the segment iff the result is > r.
double swept_clearance_m(const World& world, const Eigen::Vector2d& a_m,
                         const Eigen::Vector2d& b_m);

}  // namespace vantage::models
