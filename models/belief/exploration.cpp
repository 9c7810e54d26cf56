#include "models/belief/exploration.hpp"

#include <algorithm>
#include <cstddef>

namespace vantage::models {

std::vector<Gaussian> exploration_landmarks(const VisibilityGrid& grid, const ExplorationSpec& spec,
                                            const Eigen::Vector2d& from_m, Time now) {
  std::vector<Gaussian> landmarks;
  if (spec.landmarks_max <= 0) {
    return landmarks;
  }
  std::vector<Eigen::Vector2d> frontiers = grid.frontiers(now, spec.landmark_spacing_m);
  std::stable_sort(frontiers.begin(), frontiers.end(), [&](const auto& a, const auto& b) {
    return (a - from_m).squaredNorm() < (b - from_m).squaredNorm();
  });
  if (frontiers.size() > static_cast<std::size_t>(spec.landmarks_max)) {
    frontiers.resize(static_cast<std::size_t>(spec.landmarks_max));
  }
  landmarks.reserve(frontiers.size());
  const double variance_m2 = spec.landmark_sigma_m * spec.landmark_sigma_m;
  for (const Eigen::Vector2d& frontier_m : frontiers) {
    landmarks.push_back({frontier_m, variance_m2 * Eigen::Matrix2d::Identity()});
  }
  return landmarks;
}

}  // namespace vantage::models
