#pragma once

#include <cstdint>
#include <vector>

#include "core/pose.hpp"
#include "models/mapping/occupancy_belief.hpp"
#include "models/motion/unicycle.hpp"

namespace vantage::planner {

struct DriveOptions {
  double radius_m = 0.2;
  /// Cells with at least this probability of being occupied are avoided. With a value just above
  /// 1/2, the robot may enter unknown cells (it has a bumper). With a value below 1/2, it may
  /// enter only observed cells.
  double occupied_from = 0.51;
  /// Cells with at most this probability of being occupied are assumed to be free.
  double free_up_to = 0.35;
};

/// Area in which a disc may drive according to the map belief, with the distances to unknown cells.
class DriveMap {
 public:
  DriveMap(const models::OccupancyBelief& belief, const DriveOptions& options);

  /// False if the disc touches an occupied cell or the grid's edge anywhere along the arc. A robot
  /// that is already too near to an occupied cell (the map may have been wrong) may leave over
  /// cells that are not occupied. It must be clear after moving its radius plus two cells. The test
  /// is conservative where the robot is clear: the tested points are at most half a cell apart, and
  /// the disc is enlarged by a quarter of a cell.
  [[nodiscard]] bool is_free(const Pose2& from, const models::UnicycleControl& control,
                             double duration_s) const;
  [[nodiscard]] bool is_free(const Eigen::Vector2d& p_m) const;

  /// Returns the path length from the cell of `p_m` to the nearest frontier, m, in steps to the 8
  /// neighbours over cells where the disc may be. A cell is a frontier if the disc may be there,
  /// the cell is not known to be free, and one of its 4 neighbours is known to be free. Infinite if
  /// no path exists; 0 at a frontier.
  [[nodiscard]] double frontier_distance_m(const Eigen::Vector2d& p_m) const;

 private:
  [[nodiscard]] bool has_open_neighbour(int cell, const models::OccupancyBelief& belief) const;
  void fill_distances(const models::OccupancyBelief& belief);

  models::GridGeometry geometry_;
  DriveOptions options_;
  std::vector<std::uint8_t> occupied_;
  std::vector<std::uint8_t> near_;  ///< 1 if a disc centred in the cell may touch an occupied cell
  std::vector<double> frontier_distance_m_;
};

}  // namespace vantage::planner
