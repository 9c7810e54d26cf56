#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "core/index.hpp"
#include "models/world/world.hpp"

namespace vantage::planner {

/// Shortest path lengths around obstacles, between fixed points and from any position: a lower
/// bound of a robot's path length. A shortest path around boxes bends only at their corners. A
/// visibility graph of the corners, with all shortest paths between them, therefore answers a query
/// exactly.
///
/// Every answer is a lower bound for a disc of any radius. Boxes are shrunk by up to 0.2 µm to
/// allow for rounding, and walls only exclude the corners outside them. Only the kBoxesMax largest
/// boxes are used; omitting a box can only shorten paths. Because of the shrinking, paths can pass
/// between boxes that only touch, but not between overlapping boxes. reset() is O((4 boxes)³) and
/// allocates up to the size given to the constructor; the queries allocate nothing.
class GeodesicTable {
 public:
  static constexpr int kBoxesMax = 8;
  static constexpr int kCornersMax = 4 * kBoxesMax;

  explicit GeodesicTable(int points_max);

  /// Replaces all points; `world` may be null (no obstacles).
  void reset(const models::World* world, const std::vector<Eigen::Vector2d>& points_m);

  [[nodiscard]] int point_count() const { return static_cast<int>(points_.size()); }
  /// Returns the path length between points i and j, m; +∞ if one is enclosed. O(boxes + corners).
  [[nodiscard]] double path_between_m(int i, int j) const;
  /// True if no robot can be at `p_m`: inside a box or beyond a wall.
  [[nodiscard]] bool is_blocked(const Eigen::Vector2d& p_m) const;

  /// The corners visible from one position. O(corners · boxes).
  struct VisibleCorners {
    Eigen::Vector2d from_m = Eigen::Vector2d::Zero();
    int count = 0;
    int corners[kCornersMax];
    double legs_m[kCornersMax];
  };
  void find_visible_corners(const Eigen::Vector2d& from_m, VisibleCorners& out) const;
  /// Returns the path length from the position of `visible` to a point, m. O(boxes + corners).
  [[nodiscard]] double path_m(const VisibleCorners& visible, int point) const;

 private:
  [[nodiscard]] bool sees(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const;
  [[nodiscard]] double& corner_path(int i, int j) {
    return corner_paths_[index(i * corner_count_ + j)];
  }
  [[nodiscard]] const double* point_paths(int point) const {
    return point_paths_.data() + static_cast<std::ptrdiff_t>(point * corner_count_);
  }

  bool has_walls_ = false;
  models::Rectangle walls_;
  int box_count_ = 0;
  int corner_count_ = 0;
  models::Rectangle boxes_[kBoxesMax];  ///< boxes shrunk twice; these block the line of sight
  Eigen::Vector2d corners_[kCornersMax];
  std::vector<double> corner_paths_;  ///< indexed by [corner][corner]
  std::vector<Eigen::Vector2d> points_;
  std::vector<double> point_paths_;  ///< indexed by [point][corner]
};

}  // namespace vantage::planner
