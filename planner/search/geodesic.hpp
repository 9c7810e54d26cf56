#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "models/world/world.hpp"

namespace vantage::planner {

/// Lengths of shortest ways around obstacles, between fixed points and from anywhere: what a robot
/// has to travel at least, whatever it does. The shortest way among boxes is taut and bends at
/// their corners alone, so a visibility graph of the corners, closed once, answers a query exactly.
///
/// Every answer is a lower bound for a disc of any radius: boxes are shrunk by some nanometres
/// against rounding, walls do not count beyond the corners outside of them, and only the
/// kBoxesMax largest boxes are kept (leaving one out can only shorten ways). Between boxes that
/// only touch each other there is thus a way as thin as the shrinking; boxes that overlap are shut.
/// reset() is O((4 boxes)³); it allocates up to the size asked for at construction, the queries
/// nothing.
class GeodesicTable {
 public:
  static constexpr int kBoxesMax = 8;
  static constexpr int kCornersMax = 4 * kBoxesMax;

  explicit GeodesicTable(int points_max);

  /// Forgets all points; `world` may be null (nothing in the way).
  void reset(const models::World* world, const std::vector<Eigen::Vector2d>& points_m);

  [[nodiscard]] int point_count() const { return static_cast<int>(points_.size()); }
  /// Way between points i and j, m; +∞ when one is walled in. O(boxes + corners).
  [[nodiscard]] double between_m(int i, int j) const;
  /// True when no robot can be at `p_m`: in a box or beyond a wall.
  [[nodiscard]] bool is_blocked(const Eigen::Vector2d& p_m) const;

  /// The corners in sight of one place. O(corners · boxes).
  struct Outlook {
    Eigen::Vector2d from_m = Eigen::Vector2d::Zero();
    int count = 0;
    int corners[kCornersMax];
    double legs_m[kCornersMax];
  };
  void look_around(const Eigen::Vector2d& from_m, Outlook& out) const;
  /// Way from there to a point, m. O(boxes + corners).
  [[nodiscard]] double way_m(const Outlook& outlook, int point) const;

 private:
  [[nodiscard]] bool sees(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const;
  [[nodiscard]] double& corner_way(int i, int j) {
    return corner_ways_[static_cast<std::size_t>(i * corner_count_ + j)];
  }
  [[nodiscard]] const double* point_ways(int point) const {
    return point_ways_.data() + static_cast<std::ptrdiff_t>(point * corner_count_);
  }

  bool has_walls_ = false;
  models::Rectangle walls_;
  int box_count_ = 0;
  int corner_count_ = 0;
  models::Rectangle boxes_[kBoxesMax];  ///< shrunk twice: what blocks sight
  Eigen::Vector2d corners_[kCornersMax];
  std::vector<double> corner_ways_;  ///< [corner][corner]
  std::vector<Eigen::Vector2d> points_;
  std::vector<double> point_ways_;  ///< [point][corner]
};

}  // namespace vantage::planner
