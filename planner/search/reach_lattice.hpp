#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/index.hpp"
#include "models/motion/unicycle.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// The positions that a robot can reach after each step, as planar cells per heading, in the frame
/// of its start pose. Headings are exact, since every turn is an integer multiple of one angle.
/// Positions are square cells within the convex hull of the reachable set (its support in sixteen
/// directions). The lattice depends only on the steps, so it serves every start pose.
class ReachLattice {
 public:
  /// Numbers of cells per length of the longest step, the finest layout first.
  static constexpr std::array<double, 10> kCellsPerStep = {24.0, 16.0, 12.0, 8.0, 6.0,
                                                           4.0,  3.0,  2.0,  1.5, 1.0};
  static constexpr double kEdge_m = 1e-6;  ///< margin added to cells, ranges and path lengths, m

  explicit ReachLattice(int horizon_max);

  /// Tabulates the controls of `problem` (about 50 µs) unless they equal the last ones. False if
  /// turns are not integer multiples of one angle, or are too many.
  bool reset(const SearchProblem& problem);

  [[nodiscard]] double unit_rad() const { return unit_rad_; }
  [[nodiscard]] double step_m() const { return step_m_; }
  /// Return, by control, the end pose in the body frame and the turn in units.
  [[nodiscard]] const std::vector<Pose2>& ends() const { return ends_; }
  [[nodiscard]] int turn(std::size_t control) const { return turns_[control]; }

  /// Cells of one heading at one depth. The cells of a box are stored; row() returns the reachable
  /// ones. A control moves a cell onto four cells, which belong to the plane if they can be
  /// reached.
  struct Plane {
    int left = 0;
    int bottom = 0;
    int width = 0;
    int height = 0;
    std::size_t begin = 0;  ///< offset among the cells of its depth
    int low = 0;            ///< first and last row with reachable cells
    int high = -1;
    std::array<double, 7> rights;  ///< limits of row 0, by half-plane, in cells
    std::array<double, 7> lefts;
    [[nodiscard]] std::size_t size() const { return index(width) * index(height); }
    [[nodiscard]] bool has(int i, int j) const {
      return i >= left && i < left + width && j >= bottom && j < bottom + height;
    }
    [[nodiscard]] std::ptrdiff_t at(int i, int j) const {
      return static_cast<std::ptrdiff_t>(j - bottom) * width + i - left;
    }
  };
  struct Row {
    int left = 0;
    int right = -1;
  };
  /// Returns the reachable cells of row j.
  static Row row(const Plane& plane, int j);

  /// Offset from a cell to the lower left of the four cells that a control leads to.
  struct Shift {
    int x = 0;
    int y = 0;
  };
  /// One depth, that is, a number of steps from the start pose: headings −turns … turns, in units.
  struct Level {
    int turns = 0;
    std::size_t first_plane = 0;
    Plane any;              ///< union over all headings
    std::size_t begin = 0;  ///< offset of its cells among those of all depths
    std::size_t size = 0;
  };
  struct Layout {
    double cell_m = 0.0;
    std::vector<Plane> planes;
    std::vector<Level> levels;  ///< index 1 … horizon; 0 is unused
    std::vector<Shift> shifts;  ///< indexed by [heading][control]
    [[nodiscard]] const Plane& plane(int t, int n) const {
      const Level& level = levels[index(t)];
      return planes[level.first_plane + index(n + level.turns)];
    }
  };
  /// Returns the finest layout with at most `cells_max` cells over `steps` steps and
  /// `level_cells_max` per depth; null if there is none.
  [[nodiscard]] const Layout* layout(int steps, std::size_t cells_max,
                                     std::size_t level_cells_max) const;
  [[nodiscard]] const Shift& shift(const Layout& layout, int n, std::size_t control) const {
    return layout.shifts[index(n + most_turns_) * ends_.size() + control];
  }

 private:
  static constexpr int kDirections = 16;
  using Support = std::array<double, kDirections>;  ///< m; −∞: nothing is reached

  bool table(const SearchProblem& problem);
  void reach();
  void lay_out(double ratio, Layout& out) const;
  [[nodiscard]] Plane plane_of(const Support& support, double cell_m) const;

  // Tabulated inputs.
  std::vector<models::UnicycleControl> controls_;
  double step_s_ = 0.0;
  int horizon_ = 0;
  bool is_tabled_ = false;

  int turn_most_ = 0;   ///< largest turn of one control, in units
  int most_turns_ = 0;  ///< largest turn after all steps, in units
  double unit_rad_ = 0.0;
  double step_m_ = 0.0;  ///< m; length of the longest step
  std::vector<int> turns_;
  std::vector<Pose2> ends_;
  std::vector<Support> supports_;  ///< supports of the planes, by level from 0 on
  std::array<Layout, kCellsPerStep.size()> layouts_;
};

}  // namespace vantage::planner
