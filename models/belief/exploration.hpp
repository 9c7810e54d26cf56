#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "models/belief/gaussian.hpp"
#include "models/world/grid.hpp"

namespace vantage::models {

/// Placement and number of exploration landmarks.
struct ExplorationSpec {
  double landmark_sigma_m = 1.0;  ///< m; 1σ of the Gaussian prior (l, Σ_l) of each pseudo-target
  double landmark_spacing_m = 1.0;  ///< m; minimum distance between two landmarks
  int landmarks_max = 12;           ///< maximum number; the nearest to the robot are used
  /// True: landmarks are used only while a robot's belief holds fewer targets than the scenario
  /// has. False: always, because a target may also have passed unseen.
  bool until_found = false;
};

/// Returns the exploration landmarks: static planar pseudo-targets N(l, landmark_sigma_m² I₂) at
/// the frontiers of the explored area. Returns the `landmarks_max` nearest to `from_m` by ascending
/// distance (ties: in grid order). A plan that observes a landmark gains its entropy, so it leads
/// to unexplored ground. Landmarks depend on the grid alone: an explored one is absent from the
/// next call. Returns none when `landmarks_max` ≤ 0 or nothing is left to explore. Allocates.
/// Source: dissertation 3.4, Alg. 5.
std::vector<Gaussian> exploration_landmarks(const VisibilityGrid& grid, const ExplorationSpec& spec,
                                            const Eigen::Vector2d& from_m, Time now);

}  // namespace vantage::models
