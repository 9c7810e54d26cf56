#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "models/mapping/occupancy_belief.hpp"

namespace vantage::models {

/// A range finder that sends a fan of beams, evenly spaced over its field of view.
struct BeamSensor {
  int beams = 48;
  double field_of_view_rad = 2.0 * kPi;  ///< 2π: the last beam does not repeat the first
  double range_min_m = 0.0;
  double range_max_m = 1.5;
  double sigma_m = 0.01;  ///< m; 1σ of a range

  /// Returns the bearing of beam `beam` in the body frame, in (−π, π].
  [[nodiscard]] double bearing_rad(int beam) const;
  /// Returns the mean reading when the nearest obstacle is at `distance_m`: 0 below range_min_m,
  /// range_max_m beyond range_max_m, otherwise the distance. Source: dissertation 4.13.
  [[nodiscard]] double mean_range_m(double distance_m) const;
  /// Returns the reading from which on a beam counts as no hit: range_max_m − 3 σ.
  [[nodiscard]] double no_hit_range_m() const { return range_max_m - 3.0 * sigma_m; }
};

/// Throws UsageError if a field of `sensor` is out of its range.
void require_valid(const BeamSensor& sensor);

/// Cells along one beam, nearest first. Reusable: fill it again for each beam.
struct BeamProfile {
  std::vector<int> cell;
  std::vector<double> occupancy;  ///< o_j in [0, 1]
  std::vector<double> enter_m;    ///< m along the beam, ascending; start of cell j
  std::vector<double> exit_m;     ///< m along the beam; end of cell j

  [[nodiscard]] int size() const { return static_cast<int>(occupancy.size()); }
  void clear();
  void push_back(int cell_index, double occupancy_probability, double from_m, double to_m);
};

/// Fills `out` with the cells along a beam from `from_m` within the sensor's range. The first cell
/// is left out because the vehicle is in it. Stops after the first cell that is certainly occupied.
/// Allocates only while `out` grows.
void trace_beam(const OccupancyBelief& belief, const BeamSensor& sensor,
                const Eigen::Vector2d& from_m, double bearing_rad, BeamProfile& out);

}  // namespace vantage::models
