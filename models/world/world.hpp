#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace vantage::models {

/// An axis-aligned rectangle of the plane.
struct Rectangle {
  Eigen::Vector2d min_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d max_m = Eigen::Vector2d::Zero();
  [[nodiscard]] bool contains(const Eigen::Vector2d& p_m) const;
};

/// An upright box on the ground that nothing passes through or sees through.
struct Obstacle {
  Rectangle footprint;
  double height_m = 10.0;
};

/// A part of the ground with a cost of its own (mud for wheels, wind for wings).
struct Region {
  std::string name;
  Rectangle footprint;
  double cost_per_step = 0.0;
};

/// The lab or field: a rectangle with boxes in it.
struct World {
  Rectangle bounds;
  double ceiling_m = 10.0;
  std::vector<Obstacle> obstacles;
  std::vector<Region> regions;
};

/// Distance from `p_m` to the nearest obstacle or wall, exactly; negative inside an obstacle or
/// outside the bounds. Obstacles count whatever their height.
double clearance_m(const World& world, const Eigen::Vector2d& p_m);

/// Some of a world's obstacles, by index, as many as matter around one place.
struct NearbyObstacles {
  static constexpr std::size_t kMax = 16;
  std::size_t count = 0;
  bool is_complete = true;  ///< false: there were more, and none can be left out
  std::uint32_t indices[kMax] = {};
};
/// Those that come within `reach_m` of `p_m`, by their bounding boxes: the others change no
/// clearance below reach_m − d within d of there.
NearbyObstacles nearby_obstacles(const World& world, const Eigen::Vector2d& p_m, double reach_m);
/// As above, of `nearby` and the walls alone.
double clearance_m(const World& world, const NearbyObstacles& nearby, const Eigen::Vector2d& p_m);

/// True when the closed segment from `a_m` to `b_m` passes through the interior of no obstacle.
bool line_of_sight(const World& world, const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m);

/// Sum of cost_per_step over the regions that contain `p_m`.
double region_cost(const World& world, const Eigen::Vector2d& p_m);

/// Exact distance between two points that move linearly over the same unit of time:
/// min over s in [0, 1] of ‖(a0 − b0) + s ((a1 − a0) − (b1 − b0))‖. Closed form; catches what
/// sampling would tunnel through.
double closest_approach_m(const Eigen::Vector3d& a0_m, const Eigen::Vector3d& a1_m,
                          const Eigen::Vector3d& b0_m, const Eigen::Vector3d& b1_m);

/// Distance from the segment a–b to the nearest obstacle or wall of the plane, exactly; negative
/// or zero when it touches one. The swept-disc test: a disc of radius r is clear iff this is > r.
double swept_clearance_m(const World& world, const Eigen::Vector2d& a_m,
                         const Eigen::Vector2d& b_m);

}  // namespace vantage::models
