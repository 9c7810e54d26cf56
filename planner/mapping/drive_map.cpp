#include "planner/mapping/drive_map.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "core/check.hpp"
#include "core/index.hpp"

namespace vantage::planner {
namespace {

constexpr double kNoPath_m = std::numeric_limits<double>::infinity();

}  // namespace

DriveMap::DriveMap(const models::OccupancyBelief& belief, const DriveOptions& options)
    : geometry_(belief.geometry()),
      options_(options),
      occupied_(index(geometry_.size()), 0),
      near_(index(geometry_.size()), 0) {
  require(options.radius_m > 0.0, "a driving robot's radius must be > 0 m");
  require(options.free_up_to < options.occupied_from, "free_up_to must be below occupied_from");
  const double resolution_m = geometry_.resolution_m;
  const double reach_m = options.radius_m + 0.25 * resolution_m;
  const int reach = static_cast<int>(std::ceil(reach_m / resolution_m)) + 1;
  for (int row = -1; row <= geometry_.rows; ++row) {
    for (int column = -1; column <= geometry_.columns; ++column) {
      const bool inside =
          row >= 0 && row < geometry_.rows && column >= 0 && column < geometry_.columns;
      const int cell = row * geometry_.columns + column;
      if (inside && belief.occupancy(cell) < options.occupied_from) {
        continue;
      }
      if (inside) {
        occupied_[index(cell)] = 1;
      }
      for (int r = std::max(0, row - reach); r <= std::min(geometry_.rows - 1, row + reach); ++r) {
        for (int c = std::max(0, column - reach);
             c <= std::min(geometry_.columns - 1, column + reach); ++c) {
          const double gap_m = std::hypot(std::max(0, std::abs(r - row) - 1) * resolution_m,
                                          std::max(0, std::abs(c - column) - 1) * resolution_m);
          if (gap_m < reach_m) {
            near_[index(r * geometry_.columns + c)] = 1;
          }
        }
      }
    }
  }
  fill_distances(belief);
}

bool DriveMap::is_free(const Eigen::Vector2d& p_m) const {
  const int cell = geometry_.index_of(p_m);
  return cell >= 0 && near_[index(cell)] == 0;
}

bool DriveMap::is_free(const Pose2& from, const models::UnicycleControl& control,
                       double duration_s) const {
  const double length_m = std::abs(control.speed_mps) * duration_s;
  const int pieces = static_cast<int>(std::ceil(length_m / (0.5 * geometry_.resolution_m)));
  const double leave_m = options_.radius_m + 2.0 * geometry_.resolution_m;
  bool has_left = is_free(from.position_m());
  for (int piece = 1; piece <= pieces; ++piece) {
    const Eigen::Vector2d p_m =
        models::step_unicycle(from, control, duration_s * piece / pieces).position_m();
    const int cell = geometry_.index_of(p_m);
    if (cell < 0 || occupied_[index(cell)] != 0) {
      return false;
    }
    const bool is_near = near_[index(cell)] != 0;
    if (is_near && (has_left || (p_m - from.position_m()).norm() > leave_m)) {
      return false;
    }
    has_left = has_left || !is_near;
  }
  return has_left || pieces == 0;
}

bool DriveMap::has_open_neighbour(int cell, const models::OccupancyBelief& belief) const {
  const int column = cell % geometry_.columns;
  const int row = cell / geometry_.columns;
  const auto is_open = [&](int c) {
    return near_[index(c)] == 0 && belief.occupancy(c) <= options_.free_up_to;
  };
  return (column > 0 && is_open(cell - 1)) ||
         (column + 1 < geometry_.columns && is_open(cell + 1)) ||
         (row > 0 && is_open(cell - geometry_.columns)) ||
         (row + 1 < geometry_.rows && is_open(cell + geometry_.columns));
}

void DriveMap::fill_distances(const models::OccupancyBelief& belief) {
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  frontier_distance_m_.assign(index(geometry_.size()), kNoPath_m);
  for (int cell = 0; cell < geometry_.size(); ++cell) {
    if (near_[index(cell)] == 0 && belief.occupancy(cell) > options_.free_up_to &&
        has_open_neighbour(cell, belief)) {
      frontier_distance_m_[index(cell)] = 0.0;
      open.push({0.0, cell});
    }
  }
  while (!open.empty()) {
    const auto [path_m, cell] = open.top();
    open.pop();
    if (path_m > frontier_distance_m_[index(cell)]) {
      continue;
    }
    const int column = cell % geometry_.columns;
    const int row = cell / geometry_.columns;
    for (int r = std::max(0, row - 1); r <= std::min(geometry_.rows - 1, row + 1); ++r) {
      for (int c = std::max(0, column - 1); c <= std::min(geometry_.columns - 1, column + 1); ++c) {
        const int other = r * geometry_.columns + c;
        const double step_m = geometry_.resolution_m * std::hypot(r - row, c - column);
        if (near_[index(other)] == 0 && path_m + step_m < frontier_distance_m_[index(other)]) {
          frontier_distance_m_[index(other)] = path_m + step_m;
          open.push({path_m + step_m, other});
        }
      }
    }
  }
}

double DriveMap::frontier_distance_m(const Eigen::Vector2d& p_m) const {
  const int cell = geometry_.index_of(p_m);
  return cell < 0 ? kNoPath_m : frontier_distance_m_[index(cell)];
}

}  // namespace vantage::planner
