#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/index.hpp"
#include "models/motion/unicycle.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// Where a robot can be after each step, as cells of a plane for each heading, in the frame of the
/// pose that it starts from: headings are exact, for every turn is a whole multiple of one, and
/// places are square cells within the convex hull of what controls lead to (its support in sixteen
/// directions). Only steps count, so one lattice serves every pose.
class ReachLattice {
 public:
  /// Of one step's way, cells are so wide; finest first.
  static constexpr std::array<double, 10> kCellsPerStep = {24.0, 16.0, 12.0, 8.0, 6.0,
                                                           4.0,  3.0,  2.0,  1.5, 1.0};
  static constexpr double kEdge_m = 1e-6;  ///< cells, ranges and ways are wider by so much

  explicit ReachLattice(int horizon_max);

  /// Tables the controls of `problem`, some 50 µs, unless they are those of the last one. False:
  /// turns are not whole multiples of one, or too many.
  bool reset(const SearchProblem& problem);

  [[nodiscard]] double unit_rad() const { return unit_rad_; }
  [[nodiscard]] double step_m() const { return step_m_; }
  /// In the body frame, by control: where it ends, and its turn in units.
  [[nodiscard]] const std::vector<Pose2>& ends() const { return ends_; }
  [[nodiscard]] int turn(std::size_t control) const { return turns_[control]; }

  /// Cells of one heading at one depth: those of a box, of which `row()` says which can be reached.
  /// A moved cell lies within four of them, if it can be reached.
  struct Plane {
    int left = 0;
    int bottom = 0;
    int width = 0;
    int height = 0;
    std::size_t begin = 0;  ///< among the cells of its depth
    int low = 0;            ///< rows that have cells
    int high = -1;
    std::array<double, 7> rights;  ///< of the row through the origin, by half-plane, in cells
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
  /// Cells of row j that can be reached.
  static Row row(const Plane& plane, int j);

  /// A control leads from a cell to four whose lower left is so many further.
  struct Shift {
    int x = 0;
    int y = 0;
  };
  /// One depth, a step count from where the robot is: headings −turns … turns, in units.
  struct Level {
    int turns = 0;
    std::size_t first_plane = 0;
    Plane any;              ///< whatever the heading
    std::size_t begin = 0;  ///< of its cells among those of all depths
    std::size_t size = 0;
  };
  struct Layout {
    double cell_m = 0.0;
    std::vector<Plane> planes;
    std::vector<Level> levels;  ///< 1 …
    std::vector<Shift> shifts;  ///< [heading][control]
    [[nodiscard]] const Plane& plane(int t, int n) const {
      const Level& level = levels[index(t)];
      return planes[level.first_plane + index(n + level.turns)];
    }
  };
  /// The finest for so many steps of at most so many cells, and of one depth; null: none.
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

  // What is tabled.
  std::vector<models::UnicycleControl> controls_;
  double step_s_ = 0.0;
  int horizon_ = 0;
  bool is_tabled_ = false;

  int turn_most_ = 0;   ///< of one control, in units
  int most_turns_ = 0;  ///< after all steps
  double unit_rad_ = 0.0;
  double step_m_ = 0.0;  ///< longest way of one step
  std::vector<int> turns_;
  std::vector<Pose2> ends_;
  std::vector<Support> supports_;  ///< of planes, level after level from 0 on
  std::array<Layout, kCellsPerStep.size()> layouts_;
};

}  // namespace vantage::planner
