#pragma once

#include <Eigen/Core>

#include "models/world/grid.hpp"

namespace vantage::models {

/// Iterator over the cells that a ray crosses, nearest first, each once.
///
///   for (RayWalk walk(geometry, from_m, bearing_rad, 1.5); walk.next();) { use walk.cell(); }
///
/// Starts in the cell that contains `from_m` (no cells if `from_m` is outside the grid), and ends
/// at `range_max_m` or at the grid's edge. Each cell has the span [enter_m, exit_m) along the ray;
/// the spans cover [0, end) without gaps. A ray through a corner crosses one of the two adjacent
/// cells, with a span of length 0 or of rounding size. No allocation, O(1) per cell.
/// Source: Amanatides and Woo, A fast voxel traversal algorithm for ray tracing (1987).
class RayWalk {
 public:
  RayWalk(const GridGeometry& geometry, const Eigen::Vector2d& from_m, double bearing_rad,
          double range_max_m);

  /// Moves to the next cell; the first call moves to the first cell. Returns false when the ray has
  /// ended.
  bool next();
  [[nodiscard]] int cell() const { return row_ * columns_ + column_; }
  /// Returns the distance along the ray at which the cell begins, m.
  [[nodiscard]] double enter_m() const { return enter_m_; }
  /// Returns the distance along the ray at which the cell, or the ray itself, ends, m.
  [[nodiscard]] double exit_m() const;

 private:
  int columns_ = 0;
  int rows_ = 0;
  int column_ = 0;
  int row_ = 0;
  int column_step_ = 0;
  int row_step_ = 0;
  bool begun_ = false;
  bool ended_ = false;
  double enter_m_ = 0.0;
  double next_column_m_ = 0.0;  ///< distance along the ray to the next column's edge
  double next_row_m_ = 0.0;
  double column_pitch_m_ = 0.0;  ///< distance along the ray between column edges
  double row_pitch_m_ = 0.0;
  double range_max_m_ = 0.0;
};

}  // namespace vantage::models
