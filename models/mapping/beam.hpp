#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "models/mapping/occupancy_belief.hpp"

namespace vantage::models {

/// A range finder with beams evenly spaced over its field of view.
struct BeamSensor {
  int beams = 48;
  double field_of_view_rad = 2.0 * kPi;  ///< 2π: the last beam does not coincide with the first
  double range_min_m = 0.0;
  double range_max_m = 1.5;
  double sigma_m = 0.01;  ///< m; 1σ of a range

  /// Returns the bearing of beam k in the body frame, in (−π, π], rad.
  [[nodiscard]] double bearing_rad(int beam) const;
  /// Returns the mean of a reading when the nearest obstacle is at `distance_m`: 0 below
  /// range_min_m, range_max_m beyond range_max_m, otherwise the distance. Source: dissertation, eq.
  /// 4.13.
  [[nodiscard]] double mean_range_m(double distance_m) const;
  /// Returns the smallest reading that means "nothing hit": range_max_m − 3 σ.
  [[nodiscard]] double no_hit_range_m() const { return range_max_m - 3.0 * sigma_m; }
};

/// Throws UsageError if a parameter of `sensor` is out of range.
void require_valid(const BeamSensor& sensor);

/// The cells that one beam may hit, nearest first. The object can be reused for many beams.
struct BeamProfile {
  std::vector<int> cell;
  std::vector<double> occupancy;  ///< o_j in [0, 1]
  std::vector<double> enter_m;    ///< start of cell j along the beam, ascending
  std::vector<double> exit_m;     ///< end of cell j along the beam

  [[nodiscard]] int size() const { return static_cast<int>(occupancy.size()); }
  void clear();
  void push_back(int cell_index, double occupancy_probability, double from_m, double to_m);
};

/// Stores in `out` the cells that a beam from `from_m` may hit within the sensor's range. The first
/// cell is left out, because the vehicle is in it. The list ends after the first cell that is
/// certainly occupied. Allocates only when `out` must grow.
void trace_beam(const OccupancyBelief& belief, const BeamSensor& sensor,
                const Eigen::Vector2d& from_m, double bearing_rad, BeamProfile& out);

}  // namespace vantage::models
