#pragma once

#include <cstdint>
#include <vector>

#include "core/pose.hpp"
#include "models/mapping/occupancy_belief.hpp"
#include "models/motion/unicycle.hpp"

namespace vantage::planner {

struct DriveOptions {
  double radius_m = 0.2;
  /// Cells at least this likely to be occupied are kept away from. Just above 1/2: the unknown may
  /// be entered (a robot with a bumper); below 1/2: only what has been seen.
  double occupied_from = 0.51;
  /// Cells at most this likely to be occupied are known to be free.
  double free_up_to = 0.35;
};

/// Where a disc may drive as far as the belief goes, and how far it is to what is not known.
class DriveMap {
 public:
  DriveMap(const models::OccupancyBelief& belief, const DriveOptions& options);

  /// False when the disc touches an occupied cell or the grid's edge somewhere along the arc. A
  /// robot that stands too near already (the map may have been wrong) may leave: over cells that
  /// are not occupied themselves, and it must be clear before it has gone its radius and two cells.
  /// Sound from where it is clear: between the points it looks at, no farther apart than half a
  /// cell, the disc is taken to be larger by a quarter of a cell.
  [[nodiscard]] bool is_free(const Pose2& from, const models::UnicycleControl& control,
                             double duration_s) const;
  [[nodiscard]] bool is_free(const Eigen::Vector2d& p_m) const;

  /// Length of the way from the cell of `p_m` to the nearest frontier, over cells where the disc
  /// may be, by steps to the 8 neighbours, m. A frontier is such a cell that is not known to be
  /// free and lies beside one that is (beside the 4). Infinite when there is no way; 0 at a
  /// frontier.
  [[nodiscard]] double to_frontier_m(const Eigen::Vector2d& p_m) const;

 private:
  [[nodiscard]] bool has_open_neighbour(int cell, const models::OccupancyBelief& belief) const;
  void fill_distances(const models::OccupancyBelief& belief);

  models::GridGeometry geometry_;
  DriveOptions options_;
  std::vector<std::uint8_t> occupied_;
  std::vector<std::uint8_t> near_;  ///< the disc may touch something from somewhere in it
  std::vector<double> to_frontier_m_;
};

}  // namespace vantage::planner
