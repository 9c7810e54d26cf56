#include "sim/rover/route.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

#include "core/index.hpp"

namespace vantage::sim {
namespace {

constexpr double kResolutionMinM = 0.1;
constexpr double kCellsPerSideMax = 128.0;
constexpr double kMarginM = 0.05;
constexpr double kDepartureM = 0.3;

}  // namespace

RouteMap::RouteMap(const models::World& world)
    : geometry_(models::GridGeometry::covering(
          world.bounds,
          std::max(kResolutionMinM,
                   (world.bounds.max_m - world.bounds.min_m).maxCoeff() / kCellsPerSideMax))) {
  clearance_m_.reserve(static_cast<std::size_t>(geometry_.size()));
  for (int index = 0; index < geometry_.size(); ++index) {
    clearance_m_.push_back(models::clearance_m(world, geometry_.centre_m(index)));
  }
}

double RouteMap::clearance_needed_m(double radius_m) const {
  // Adds half a diagonal step, the largest distance of a point between two centres from the nearer
  // centre.
  return radius_m + kMarginM + geometry_.resolution_m / std::numbers::sqrt2;
}

// Long function: it makes one grid search, with arrays of costs and parents.
std::vector<Eigen::Vector2d> RouteMap::route(const Eigen::Vector2d& from_m,
                                             const Eigen::Vector2d& to_m, double radius_m,
                                             const std::vector<Disc>& blocked) const {
  const int start = geometry_.index_of(from_m);
  const int goal = geometry_.index_of(to_m);
  if (start < 0 || goal < 0) {
    return {};
  }
  const double needed_m = clearance_needed_m(radius_m);
  // A disc may start closer to obstacles than a route allows; near the start, less clearance is
  // required.
  const double departure_m = std::max(kDepartureM, 1.5 * geometry_.resolution_m);
  const auto is_open = [&](int cell) {
    const Eigen::Vector2d centre_m = geometry_.centre_m(cell);
    const double clearance_m = clearance_m_[index(cell)];
    if (clearance_m < needed_m &&
        (clearance_m < radius_m || (centre_m - from_m).norm() > departure_m)) {
      return false;
    }
    return std::none_of(blocked.begin(), blocked.end(), [&](const Disc& disc) {
      return (centre_m - disc.centre_m).norm() < disc.radius_m;
    });
  };
  if (clearance_m_[index(goal)] < needed_m || !is_open(goal)) {
    return {};
  }

  const auto cells = static_cast<std::size_t>(geometry_.size());
  std::vector<double> cost(cells, std::numeric_limits<double>::infinity());
  std::vector<int> parent(cells, -1);
  using Entry = std::pair<double, int>;  // (cost + remaining distance, cell)
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto to_go = [&](int cell) {
    return (geometry_.centre_m(cell) - geometry_.centre_m(goal)).norm();
  };
  cost[index(start)] = 0.0;
  open.emplace(to_go(start), start);
  while (!open.empty()) {
    const auto [priority, cell] = open.top();
    open.pop();
    if (cell == goal) {
      break;
    }
    const double here = cost[index(cell)];
    if (priority > here + to_go(cell) + 1e-9) {
      continue;  // obsolete entry: a cheaper entry replaced it
    }
    const int column = cell % geometry_.columns;
    const int row = cell / geometry_.columns;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const int x = column + dx;
        const int y = row + dy;
        if ((dx == 0 && dy == 0) || x < 0 || y < 0 || x >= geometry_.columns ||
            y >= geometry_.rows) {
          continue;
        }
        const int next = y * geometry_.columns + x;
        const double reached =
            here + geometry_.resolution_m * (dx != 0 && dy != 0 ? std::numbers::sqrt2 : 1.0);
        if (reached < cost[index(next)] - 1e-12 && is_open(next)) {
          cost[index(next)] = reached;
          parent[index(next)] = cell;
          open.emplace(reached + to_go(next), next);
        }
      }
    }
  }
  if (goal != start && parent[index(goal)] < 0) {
    return {};
  }
  std::vector<Eigen::Vector2d> path{to_m};
  for (int cell = goal; cell != start; cell = parent[index(cell)]) {
    path.push_back(geometry_.centre_m(cell));
  }
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace vantage::sim
