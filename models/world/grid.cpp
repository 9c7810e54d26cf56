#include "models/world/grid.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/check.hpp"
#include "core/index.hpp"
#include "models/world/border.hpp"

namespace vantage::models {
namespace {

constexpr double kSlack_m = 1e-9;  // tolerance for rounding in sums of cell sizes

// Cells [first, last] on one axis that [low_m, high_m] overlaps; first > last if there are none.
struct CellSpan {
  int first = 0;
  int last = -1;
};
CellSpan span_of(double low_m, double high_m, double origin_m, double resolution_m, int cells) {
  const double count = cells;
  const double first = std::floor((low_m + kSlack_m - origin_m) / resolution_m);
  const double last = std::ceil((high_m - kSlack_m - origin_m) / resolution_m) - 1.0;
  return {static_cast<int>(std::clamp(first, 0.0, count)),
          static_cast<int>(std::clamp(last, -1.0, count - 1.0))};
}

// Returns the largest float that is at most `value`, which must be finite.
float rounded_down(double value) {
  const float nearest = static_cast<float>(value);
  if (static_cast<double>(nearest) <= value) {
    return nearest;
  }
  // The next float toward minus infinity: the bits of negative floats grow with their magnitude.
  const auto bits = std::bit_cast<std::uint32_t>(nearest);
  return std::bit_cast<float>(nearest > 0.0F ? bits - 1 : bits + 1);
}

// Greedy thinning of points. Selected points are hashed by squares with sides of at least
// `spacing_m`, so points that are too near can only be in the 3 × 3 squares around a point.
class Thinner {
 public:
  Thinner(const GridGeometry& geometry, double spacing_m)
      : origin_m_(geometry.origin_m),
        spacing_m_(spacing_m),
        bucket_m_(std::max(spacing_m, geometry.resolution_m)),
        columns_(static_cast<int>(geometry.columns * geometry.resolution_m / bucket_m_) + 1),
        rows_(static_cast<int>(geometry.rows * geometry.resolution_m / bucket_m_) + 1),
        newest_(index(columns_ * rows_), -1) {}

  void offer(const Eigen::Vector2d& p_m) {
    const int column = static_cast<int>((p_m.x() - origin_m_.x()) / bucket_m_);
    const int row = static_cast<int>((p_m.y() - origin_m_.y()) / bucket_m_);
    for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r) {
      for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 1); ++c) {
        for (int k = newest_[index(r * columns_ + c)]; k >= 0; k = older_[index(k)]) {
          if ((kept_[index(k)] - p_m).norm() < spacing_m_) {
            return;
          }
        }
      }
    }
    int& newest = newest_[index(row * columns_ + column)];
    older_.push_back(newest);
    newest = static_cast<int>(kept_.size());
    kept_.push_back(p_m);
  }
  std::vector<Eigen::Vector2d> take() && { return std::move(kept_); }

 private:
  Eigen::Vector2d origin_m_;
  double spacing_m_;
  double bucket_m_;
  int columns_;
  int rows_;
  std::vector<int> newest_;  // per bucket: index in kept_ of its newest point
  std::vector<int> older_;   // per selected point: index of the previous point in its bucket
  std::vector<Eigen::Vector2d> kept_;
};

}  // namespace

GridGeometry GridGeometry::covering(const Rectangle& bounds, double resolution_m) {
  require(resolution_m > 0.0, "grid resolution must be > 0 m");
  const Eigen::Vector2d size_m = bounds.max_m - bounds.min_m;
  require(size_m.x() > 0.0 && size_m.y() > 0.0, "grid bounds must have a positive area");
  const Eigen::Vector2d cells = size_m / resolution_m;
  require(cells.x() * cells.y() < 1e8, "grid must have fewer than 1e8 cells");
  return {bounds.min_m, resolution_m,
          std::max(1, static_cast<int>(std::ceil(cells.x() - kSlack_m))),
          std::max(1, static_cast<int>(std::ceil(cells.y() - kSlack_m)))};
}

Eigen::Vector2d GridGeometry::centre_m(int cell) const {
  return origin_m + resolution_m * Eigen::Vector2d(cell % columns + 0.5, cell / columns + 0.5);
}

int GridGeometry::index_of(const Eigen::Vector2d& p_m) const {
  const Eigen::Vector2d cell = (p_m - origin_m) / resolution_m;
  if (!(cell.x() >= 0.0 && cell.y() >= 0.0 && cell.x() <= columns && cell.y() <= rows)) {
    return -1;
  }
  const int column = std::min(static_cast<int>(cell.x()), columns - 1);
  const int row = std::min(static_cast<int>(cell.y()), rows - 1);
  return row * columns + column;
}

GridGeometry GridGeometry::window(const Eigen::Vector2d& around_m, double half_m) const {
  const auto span = [&](double centre_m, double begin_m, int cells) {
    const CellSpan some =
        span_of(centre_m - half_m, centre_m + half_m, begin_m, resolution_m, cells);
    const int first = std::clamp(some.first, 0, cells - 1);
    return CellSpan{first, std::clamp(some.last, first, cells - 1)};
  };
  const CellSpan x = span(around_m.x(), origin_m.x(), columns);
  const CellSpan y = span(around_m.y(), origin_m.y(), rows);
  return {origin_m + resolution_m * Eigen::Vector2d(x.first, y.first), resolution_m,
          x.last - x.first + 1, y.last - y.first + 1};
}

std::optional<Eigen::Vector2i> GridGeometry::cell_offset_of(const GridGeometry& other) const {
  constexpr double kCellsMax = 1e8;
  const Eigen::Vector2d cells = (other.origin_m - origin_m) / resolution_m;
  const Eigen::Vector2d whole = cells.array().round();
  if (other.resolution_m != resolution_m || !(cells.cwiseAbs().maxCoeff() < kCellsMax) ||
      (cells - whole).cwiseAbs().maxCoeff() * resolution_m > kSlack_m) {
    return std::nullopt;
  }
  return whole.cast<int>();
}

bool merge_stamps(const GridGeometry& geometry, std::vector<std::int64_t>& stamps_utime,
                  const GridGeometry& their_geometry, const std::vector<std::int64_t>& theirs_utime,
                  std::int64_t limit_utime) {
  const auto place = geometry.cell_offset_of(their_geometry);
  if (!place || std::ssize(theirs_utime) != their_geometry.size() ||
      std::ssize(stamps_utime) != geometry.size()) {
    return false;
  }
  const int first_column = std::max(0, place->x());
  const int last_column = std::min(geometry.columns, place->x() + their_geometry.columns);
  const int first_row = std::max(0, place->y());
  const int last_row = std::min(geometry.rows, place->y() + their_geometry.rows);
  for (int row = first_row; row < last_row; ++row) {
    for (int column = first_column; column < last_column; ++column) {
      std::int64_t& own = stamps_utime[index(row * geometry.columns + column)];
      own = std::max(own, std::min(theirs_utime[index((row - place->y()) * their_geometry.columns +
                                                      column - place->x())],
                                   limit_utime));
    }
  }
  return true;
}

OccupancyGrid rasterise(const World& world, double resolution_m) {
  OccupancyGrid grid{GridGeometry::covering(world.bounds, resolution_m), {}};
  const GridGeometry& geometry = grid.geometry;
  grid.occupied.assign(index(geometry.size()), 0);
  for (const Obstacle& obstacle : world.obstacles) {
    const Rectangle& box = obstacle.footprint;
    const CellSpan x = span_of(box.min_m.x(), box.max_m.x(), geometry.origin_m.x(), resolution_m,
                               geometry.columns);
    const CellSpan y =
        span_of(box.min_m.y(), box.max_m.y(), geometry.origin_m.y(), resolution_m, geometry.rows);
    for (int row = y.first; row <= y.last; ++row) {
      for (int column = x.first; column <= x.last; ++column) {
        grid.occupied[index(row * geometry.columns + column)] = 1;
      }
    }
  }
  return grid;
}

DistanceField::DistanceField(const World& world, double resolution_m)
    : geometry_(GridGeometry::covering(world.bounds, resolution_m)) {
  const double half_diagonal_m = resolution_m * std::sqrt(0.5) + kSlack_m;
  const auto outside_m = [](double low_m, double p_m, double high_m) {
    return std::max(low_m - p_m, p_m - high_m);
  };
  std::vector<double> outside_x_m;
  for (int column = 0; column < geometry_.columns; ++column) {
    outside_x_m.push_back(
        outside_m(world.bounds.min_m.x(), geometry_.centre_m(column).x(), world.bounds.max_m.x()));
  }
  distance_m_.resize(index(geometry_.size()));
  for (int row = 0, cell = 0; row < geometry_.rows; ++row) {
    const double outside_y_m =
        outside_m(world.bounds.min_m.y(), geometry_.centre_m(cell).y(), world.bounds.max_m.y());
    for (int column = 0; column < geometry_.columns; ++column, ++cell) {
      const double clearance = world.obstacles.empty()
                                   ? -border_distance_m(outside_x_m[index(column)], outside_y_m)
                                   : clearance_m(world, geometry_.centre_m(cell));
      // The clearance is 1-Lipschitz, so it is at least this value everywhere in the cell.
      distance_m_[index(cell)] = rounded_down(clearance - half_diagonal_m);
    }
  }
}

double DistanceField::lower_bound_m(const Eigen::Vector2d& p_m) const {
  const int cell = geometry_.index_of(p_m);
  return cell < 0 ? -1.0 : static_cast<double>(distance_m_[index(cell)]);
}

VisibilityGrid::VisibilityGrid(const World& world, double resolution_m, double memory_s)
    : VisibilityGrid(world, GridGeometry::covering(world.bounds, resolution_m), memory_s) {}

VisibilityGrid::VisibilityGrid(const World& world, const GridGeometry& geometry, double memory_s)
    : geometry_(geometry),
      memory_s_(memory_s),
      free_(index(geometry_.size()), 0),
      last_seen_(index(geometry_.size()), kNeverSeen) {
  for (int cell = 0; cell < geometry_.size(); ++cell) {
    free_[index(cell)] = clearance_m(world, geometry_.centre_m(cell)) > 0.0 ? 1 : 0;
  }
}

void VisibilityGrid::see(const SensorModel& sensor, const Viewpoint& from, const World& world,
                         Time now) {
  const Eigen::Vector2d p_m = from.world_from_body.position_m();
  const Rectangle reach{p_m.array() - sensor.range_max_m, p_m.array() + sensor.range_max_m};
  World near = {world.bounds, world.ceiling_m, {}, {}};
  for (const Obstacle& obstacle : world.obstacles) {
    if ((obstacle.footprint.min_m.array() <= reach.max_m.array()).all() &&
        (obstacle.footprint.max_m.array() >= reach.min_m.array()).all()) {
      near.obstacles.push_back(obstacle);
    }
  }
  const std::int64_t stamp = std::max<std::int64_t>(to_utime(now), kNeverSeen + 1);
  const CellSpan x = span_of(reach.min_m.x(), reach.max_m.x(), geometry_.origin_m.x(),
                             geometry_.resolution_m, geometry_.columns);
  const CellSpan y = span_of(reach.min_m.y(), reach.max_m.y(), geometry_.origin_m.y(),
                             geometry_.resolution_m, geometry_.rows);
  for (int row = y.first; row <= y.last; ++row) {
    for (int column = x.first; column <= x.last; ++column) {
      const int cell = row * geometry_.columns + column;
      std::int64_t& last_seen = last_seen_[index(cell)];
      if (!is_free(cell) || last_seen >= stamp) {
        continue;
      }
      const Eigen::Vector2d centre_m = geometry_.centre_m(cell);
      if (in_view(sensor, from, centre_m) && line_of_sight(near, p_m, centre_m)) {
        last_seen = stamp;
      }
    }
  }
}

void VisibilityGrid::merge(const VisibilityGrid& other) {
  assert(geometry_ == other.geometry_);
  std::transform(last_seen_.begin(), last_seen_.end(), other.last_seen_.begin(), last_seen_.begin(),
                 [](std::int64_t a, std::int64_t b) { return std::max(a, b); });
}

void VisibilityGrid::merge(const std::vector<std::int64_t>& last_seen_utime,
                           std::int64_t limit_utime) {
  assert(last_seen_utime.size() == last_seen_.size());
  std::transform(last_seen_.begin(), last_seen_.end(), last_seen_utime.begin(), last_seen_.begin(),
                 [&](std::int64_t own, std::int64_t theirs) {
                   return std::max(own, std::min(theirs, limit_utime));
                 });
}

bool VisibilityGrid::is_explored(int cell, Time now) const {
  const std::int64_t last_seen = last_seen_[index(cell)];
  return last_seen != kNeverSeen &&
         (memory_s_ <= 0.0 || to_seconds(now - from_utime(last_seen)) <= memory_s_);
}

double VisibilityGrid::unexplored_share(int cell, Time now) const {
  const std::int64_t last_seen = last_seen_[index(cell)];
  if (last_seen == kNeverSeen) {
    return 1.0;
  }
  return memory_s_ > 0.0 ? std::clamp(to_seconds(now - from_utime(last_seen)) / memory_s_, 0.0, 1.0)
                         : 0.0;
}

std::vector<Eigen::Vector2d> VisibilityGrid::frontiers(Time now, double spacing_m) const {
  const auto is_known = [&](int cell) { return is_free(cell) && is_explored(cell, now); };
  bool anything_known = false;
  for (int cell = 0; cell < geometry_.size() && !anything_known; ++cell) {
    anything_known = is_known(cell);
  }
  Thinner thinner(geometry_, spacing_m);
  for (int cell = 0; cell < geometry_.size(); ++cell) {
    if (!is_free(cell) || is_explored(cell, now)) {
      continue;
    }
    const int column = cell % geometry_.columns;
    const int row = cell / geometry_.columns;
    const bool is_next_to_known = (column > 0 && is_known(cell - 1)) ||
                                  (column + 1 < geometry_.columns && is_known(cell + 1)) ||
                                  (row > 0 && is_known(cell - geometry_.columns)) ||
                                  (row + 1 < geometry_.rows && is_known(cell + geometry_.columns));
    if (is_next_to_known || !anything_known) {
      thinner.offer(geometry_.centre_m(cell));
    }
  }
  return std::move(thinner).take();
}

void VisibilityGrid::set_last_seen(std::vector<std::int64_t> last_seen_utime) {
  assert(last_seen_utime.size() == last_seen_.size());
  last_seen_ = std::move(last_seen_utime);
}

}  // namespace vantage::models
