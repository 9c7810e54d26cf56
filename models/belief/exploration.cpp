#include "models/belief/exploration.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/index.hpp"

namespace vantage::models {
namespace {

// Minimum share of the unexplored area in a region.
constexpr double kRegionShareMin = 0.002;

}  // namespace

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

std::vector<UnexploredRegion> unexplored_regions(const VisibilityGrid& grid, double region_m,
                                                 int regions_max, Time now) {
  const GridGeometry& geometry = grid.geometry();
  const int side = std::max(1, static_cast<int>(std::lround(region_m / geometry.resolution_m)));
  const int columns = (geometry.columns + side - 1) / side;
  const int rows = (geometry.rows + side - 1) / side;
  std::vector<UnexploredRegion> regions(index(columns) * index(rows));
  double whole = 0.0;
  const auto for_each_cell = [&](const auto& visit) {
    for (int cell = 0; cell < geometry.size(); ++cell) {
      // The mean squared displacement of a randomly accelerated target grows with the cube of time.
      const double share =
          grid.is_free(cell) ? std::pow(grid.unexplored_share(cell, now), 3.0) : 0.0;
      if (share > 0.0) {
        const int column = cell % geometry.columns / side;
        const int row = cell / geometry.columns / side;
        visit(index(row * columns + column), geometry.centre_m(cell), share);
      }
    }
  };
  for_each_cell([&](std::size_t at, const Eigen::Vector2d& p_m, double share) {
    regions[at].centre_m += share * p_m;
    regions[at].share += share;
    whole += share;
  });
  for (UnexploredRegion& region : regions) {
    region.centre_m /= std::max(region.share, std::numeric_limits<double>::min());
  }
  std::vector<Eigen::Vector2d> nearest_m(regions.size());
  std::vector<double> nearest_m2(regions.size(), std::numeric_limits<double>::infinity());
  for_each_cell([&](std::size_t at, const Eigen::Vector2d& p_m, double share) {
    const double distance_m2 = (p_m - regions[at].centre_m).squaredNorm() / share;
    if (distance_m2 < nearest_m2[at]) {
      nearest_m2[at] = distance_m2;
      nearest_m[at] = p_m;
    }
  });
  std::vector<UnexploredRegion> kept;
  for (std::size_t at = 0; at < regions.size(); ++at) {
    if (regions[at].share > 0.0 && regions[at].share >= kRegionShareMin * whole) {
      kept.push_back({nearest_m[at], regions[at].share / whole});
    }
  }
  if (kept.size() > index(std::max(0, regions_max))) {
    std::stable_sort(kept.begin(), kept.end(),
                     [](const auto& a, const auto& b) { return a.share > b.share; });
    kept.resize(index(std::max(0, regions_max)));
  }
  return kept;
}

}  // namespace vantage::models
