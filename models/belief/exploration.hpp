#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "models/belief/gaussian.hpp"
#include "models/world/grid.hpp"

namespace vantage::models {

/// Where exploration landmarks stand and how many count.
struct ExplorationSpec {
  double landmark_sigma_m = 1.0;    ///< 1σ of the Gaussian prior (l, Σ_l) of each pseudo-target
  double landmark_spacing_m = 1.0;  ///< no two landmarks nearer than this
  int landmarks_max = 12;           ///< the nearest to the robot are used
  /// Only while a robot believes in fewer targets than there are: what is not found yet may be
  /// where nobody has looked. Else also where a target may have gone unseen.
  bool until_found = false;
};

/// Exploration landmarks: static planar pseudo-targets N(l, landmark_sigma_m² I₂) at the frontiers
/// of what has been seen, the `landmarks_max` nearest to `from_m`, by ascending distance (ties: in
/// grid order). A plan that would see one gains its entropy, hence goes and looks. They are a
/// function of the grid alone, so an explored one is gone at the next call. None when
/// `landmarks_max` ≤ 0 or nothing is left to explore. Allocates.
/// Source: dissertation 3.4, Alg. 5.
std::vector<Gaussian> exploration_landmarks(const VisibilityGrid& grid, const ExplorationSpec& spec,
                                            const Eigen::Vector2d& from_m, Time now);

}  // namespace vantage::models
