#include "planner/search/geodesic.hpp"

#include <algorithm>
#include <cmath>

#include "core/index.hpp"
#include "core/infinity.hpp"

namespace vantage::planner {
namespace {

// Paths bend at the corners of boxes shrunk once. Boxes shrunk twice block the line of sight, so
// that rounding never blocks a leg that touches a corner.
constexpr double kShrink_m = 1e-7;

models::Rectangle shrunk(const models::Rectangle& box, double by_m) {
  return {box.min_m.array() + by_m, box.max_m.array() - by_m};
}

// Extends a box that touches a wall to beyond the wall, so that no path or line of sight passes
// between the box and the wall.
models::Rectangle into_the_walls(models::Rectangle box, const models::Rectangle& walls) {
  constexpr double kBeyond_m = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    if (box.min_m(axis) <= walls.min_m(axis)) {
      box.min_m(axis) = walls.min_m(axis) - kBeyond_m;
    }
    if (box.max_m(axis) >= walls.max_m(axis)) {
      box.max_m(axis) = walls.max_m(axis) + kBeyond_m;
    }
  }
  return box;
}

double area_m2(const models::Rectangle& box) { return (box.max_m - box.min_m).prod(); }

// True if the segment passes through the box's interior. Clips the segment axis by axis.
bool passes_through(const models::Rectangle& box, const Eigen::Vector2d& a,
                    const Eigen::Vector2d& d) {
  double enter = 0.0;
  double leave = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    if (d(axis) == 0.0) {
      if (a(axis) <= box.min_m(axis) || a(axis) >= box.max_m(axis)) {
        return false;
      }
      continue;
    }
    const double s0 = (box.min_m(axis) - a(axis)) / d(axis);
    const double s1 = (box.max_m(axis) - a(axis)) / d(axis);
    enter = std::max(enter, std::min(s0, s1));
    leave = std::min(leave, std::max(s0, s1));
    if (enter >= leave) {
      return false;
    }
  }
  return true;
}

}  // namespace

GeodesicTable::GeodesicTable(int points_max) {
  corner_paths_.reserve(static_cast<std::size_t>(kCornersMax * kCornersMax));
  points_.reserve(static_cast<std::size_t>(points_max));
  point_paths_.reserve(static_cast<std::size_t>(points_max * kCornersMax));
}

bool GeodesicTable::sees(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const {
  const Eigen::Vector2d d = b_m - a_m;
  for (int i = 0; i < box_count_; ++i) {
    if (passes_through(boxes_[i], a_m, d)) {
      return false;
    }
  }
  return true;
}

// Long function: it fills several tables in turn.
void GeodesicTable::reset(const models::World* world,
                          const std::vector<Eigen::Vector2d>& points_m) {
  points_.assign(points_m.begin(), points_m.end());
  box_count_ = 0;
  corner_count_ = 0;
  has_walls_ = world != nullptr;
  if (world != nullptr) {
    const models::Rectangle* kept[kBoxesMax];
    for (const models::Obstacle& obstacle : world->obstacles) {
      const models::Rectangle* box = &obstacle.footprint;
      if ((box->max_m - box->min_m).minCoeff() <= 4.0 * kShrink_m) {
        continue;
      }
      int at = box_count_;
      while (at > 0 && area_m2(*kept[at - 1]) < area_m2(*box)) {
        --at;
      }
      if (at == kBoxesMax) {
        continue;
      }
      box_count_ = std::min(box_count_ + 1, kBoxesMax);
      for (int i = box_count_ - 1; i > at; --i) {
        kept[i] = kept[i - 1];
      }
      kept[at] = box;
    }
    // Corners outside the bounding rectangle of walls and points are irrelevant.
    walls_ = shrunk(world->bounds, -kShrink_m);
    models::Rectangle all = world->bounds;
    for (const Eigen::Vector2d& p : points_) {
      all.min_m = all.min_m.cwiseMin(p);
      all.max_m = all.max_m.cwiseMax(p);
    }
    const bool all_inside = (all.min_m.array() >= world->bounds.min_m.array()).all() &&
                            (all.max_m.array() <= world->bounds.max_m.array()).all();
    for (int i = 0; i < box_count_; ++i) {
      const models::Rectangle whole =
          all_inside ? into_the_walls(*kept[i], world->bounds) : *kept[i];
      boxes_[i] = shrunk(whole, 2.0 * kShrink_m);
      const models::Rectangle box = shrunk(whole, kShrink_m);
      for (const double x : {box.min_m.x(), box.max_m.x()}) {
        for (const double y : {box.min_m.y(), box.max_m.y()}) {
          const Eigen::Vector2d corner(x, y);
          if (all.contains(corner)) {
            corners_[corner_count_++] = corner;
          }
        }
      }
    }
  }

  corner_paths_.assign(static_cast<std::size_t>(corner_count_ * corner_count_), kInfinity);
  for (int i = 0; i < corner_count_; ++i) {
    corner_path(i, i) = 0.0;
    for (int j = 0; j < i; ++j) {
      if (sees(corners_[i], corners_[j])) {
        corner_path(i, j) = corner_path(j, i) = (corners_[i] - corners_[j]).norm();
      }
    }
  }
  for (int k = 0; k < corner_count_; ++k) {
    for (int i = 0; i < corner_count_; ++i) {
      for (int j = 0; j < corner_count_; ++j) {
        corner_path(i, j) = std::min(corner_path(i, j), corner_path(i, k) + corner_path(k, j));
      }
    }
  }
  point_paths_.assign(static_cast<std::size_t>(point_count() * corner_count_), kInfinity);
  for (int p = 0; p < point_count(); ++p) {
    double* paths = point_paths_.data() + static_cast<std::ptrdiff_t>(p * corner_count_);
    for (int c = 0; c < corner_count_; ++c) {
      const Eigen::Vector2d& point = points_[index(p)];
      if (!sees(point, corners_[c])) {
        continue;
      }
      const double leg_m = (point - corners_[c]).norm();
      for (int i = 0; i < corner_count_; ++i) {
        paths[i] = std::min(paths[i], leg_m + corner_path(c, i));
      }
    }
  }
}

bool GeodesicTable::is_blocked(const Eigen::Vector2d& p_m) const {
  return (has_walls_ && !walls_.contains(p_m)) ||
         std::any_of(boxes_, boxes_ + box_count_,
                     [&](const models::Rectangle& box) { return box.contains(p_m); });
}

double GeodesicTable::path_between_m(int i, int j) const {
  VisibleCorners visible;
  find_visible_corners(points_[index(i)], visible);
  return path_m(visible, j);
}

void GeodesicTable::find_visible_corners(const Eigen::Vector2d& from_m, VisibleCorners& out) const {
  out.from_m = from_m;
  out.count = 0;
  for (int c = 0; c < corner_count_; ++c) {
    if (sees(from_m, corners_[c])) {
      out.legs_m[out.count] = (corners_[c] - from_m).norm();
      out.corners[out.count++] = c;
    }
  }
}

double GeodesicTable::path_m(const VisibleCorners& visible, int point) const {
  const Eigen::Vector2d& to_m = points_[index(point)];
  if (sees(visible.from_m, to_m)) {
    return (to_m - visible.from_m).norm();
  }
  double path_m = kInfinity;
  for (int i = 0; i < visible.count; ++i) {
    path_m = std::min(path_m, visible.legs_m[i] + point_paths(point)[visible.corners[i]]);
  }
  return path_m;
}

}  // namespace vantage::planner
