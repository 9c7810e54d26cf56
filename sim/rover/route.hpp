#pragma once

#include <vector>

#include <Eigen/Core>

#include "models/world/grid.hpp"
#include "models/world/world.hpp"

namespace vantage::sim {

/// Disc on the ground.
struct Disc {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double radius_m = 0.0;
};

/// Planner of routes for discs over free ground: A* over the centres of square cells with eight
/// neighbours each.
/// Source: Hart, Nilsson, Raphael, A formal basis for the heuristic determination of minimum cost
/// paths (1968).
class RouteMap {
 public:
  explicit RouteMap(const models::World& world);

  /// Returns a route: cell centres from near `from_m` to near `to_m`, then `to_m` itself; empty if
  /// no route exists. Every centre is outside each disc of `blocked` and at least
  /// clearance_needed_m(radius_m) from obstacles and walls; near the start radius_m suffices.
  /// O(cells log cells); allocates memory.
  [[nodiscard]] std::vector<Eigen::Vector2d> route(const Eigen::Vector2d& from_m,
                                                   const Eigen::Vector2d& to_m, double radius_m,
                                                   const std::vector<Disc>& blocked) const;
  /// Returns the clearance that a cell's centre must have. A disc of `radius_m` that moves straight
  /// between neighbouring centres then stays 5 cm away from obstacles and walls.
  [[nodiscard]] double clearance_needed_m(double radius_m) const;

 private:
  models::GridGeometry geometry_;
  std::vector<double> clearance_m_;  ///< m; exact clearance at each cell's centre
};

}  // namespace vantage::sim
