#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "models/belief/gaussian.hpp"
#include "models/world/grid.hpp"

namespace vantage::models {

/// Placement and number of exploration landmarks.
struct ExplorationSpec {
  double landmark_sigma_m = 1.0;    ///< 1σ of the Gaussian prior (l, Σ_l) of each pseudo-target
  double landmark_spacing_m = 1.0;  ///< minimum distance between two landmarks
  int landmarks_max = 12;  ///< maximum number of landmarks; those nearest to the robot are used
  /// If true, landmarks are used only until the robot has found all targets. If false, landmarks
  /// are always used, because targets may have moved unseen.
  bool until_found = false;
};

/// Returns exploration landmarks: static planar pseudo-targets N(l, landmark_sigma_m² I₂) at the
/// frontiers of the explored area. Returns the `landmarks_max` landmarks nearest to `from_m`, by
/// ascending distance (at equal distances in grid order). A plan that observes a landmark gains
/// information, so the planner explores. Landmarks depend only on the grid, so a landmark
/// disappears once its area is explored. Empty when `landmarks_max` ≤ 0 or everything is explored.
/// Allocates.
/// Source: dissertation, section 3.4, algorithm 5.
std::vector<Gaussian> exploration_landmarks(const VisibilityGrid& grid, const ExplorationSpec& spec,
                                            const Eigen::Vector2d& from_m, Time now);

/// Unexplored part of one square region of the world.
struct UnexploredRegion {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();  ///< mean position of the unexplored cells
  double share = 0.0;  ///< share of the whole unexplored area, in (0, 1]
};

/// Divides the grid into squares of edge `region_m` and returns the unexplored part of each, in
/// the order of the squares. Each cell is weighted by the cube of unexplored_share(). The centre is
/// moved to the nearest unexplored cell of the square. Returns the `regions_max` regions with the
/// largest shares that are at least 0.2 % of the area. Allocates.
std::vector<UnexploredRegion> unexplored_regions(const VisibilityGrid& grid, double region_m,
                                                 int regions_max, Time now);

}  // namespace vantage::models
