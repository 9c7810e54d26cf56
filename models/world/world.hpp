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

/// An upright box on the ground that blocks motion and line of sight.
struct Obstacle {
  Rectangle footprint;
  double height_m = 10.0;
};

/// A region of the ground with an additional cost per step (mud for wheels, wind for aircraft).
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

/// Returns the exact distance from `p_m` to the nearest obstacle or wall; negative inside an
/// obstacle or outside the bounds. Obstacles count at any height.
double clearance_m(const World& world, const Eigen::Vector2d& p_m);

/// The indices of the obstacles near a position.
struct NearbyObstacles {
  static constexpr std::size_t kMax = 16;
  std::size_t count = 0;
  bool is_complete = true;  ///< false: more than kMax obstacles are near, so all must be checked
  std::uint32_t indices[kMax] = {};
};
/// Returns the obstacles with bounding boxes within `reach_m` of `p_m`. At a distance d from `p_m`,
/// other obstacles do not affect clearances below reach_m − d.
NearbyObstacles nearby_obstacles(const World& world, const Eigen::Vector2d& p_m, double reach_m);
/// As clearance_m(world, p_m), but considers only the obstacles in `nearby` and the walls.
double clearance_m(const World& world, const NearbyObstacles& nearby, const Eigen::Vector2d& p_m);

/// True if the closed segment from `a_m` to `b_m` does not cross the interior of any obstacle.
bool line_of_sight(const World& world, const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m);

/// Returns the sum of cost_per_step over the regions that contain `p_m`.
double region_cost(const World& world, const Eigen::Vector2d& p_m);

/// Returns the exact minimum distance between two points that move linearly during the same time:
/// min over s in [0, 1] of ‖(a0 − b0) + s ((a1 − a0) − (b1 − b0))‖. Closed form; detects contacts
/// that sampling would miss.
double closest_approach_m(const Eigen::Vector3d& a0_m, const Eigen::Vector3d& a1_m,
                          const Eigen::Vector3d& b0_m, const Eigen::Vector3d& b1_m);

/// Returns the exact distance from the segment a–b to the nearest obstacle or wall in the plane; ≤
/// 0 when it touches one. A moving disc of radius r is clear of obstacles if and only if the result
/// is > r.
double swept_clearance_m(const World& world, const Eigen::Vector2d& a_m,
                         const Eigen::Vector2d& b_m);

}  // namespace vantage::models
