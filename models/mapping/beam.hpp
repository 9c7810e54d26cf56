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
  double sigma_m = 0.01;  ///< 1σ of a range

  /// Bearing of beam k in the body frame, in (−π, π].
  [[nodiscard]] double bearing_rad(int beam) const;
  /// Mean of a reading when the first thing met is at `distance_m`: 0 below range_min_m,
  /// range_max_m beyond that, else the distance. Source: dissertation 4.13.
  [[nodiscard]] double mean_range_m(double distance_m) const;
  /// A reading from here on means that nothing was met: range_max_m less 3 σ.
  [[nodiscard]] double no_hit_range_m() const { return range_max_m - 3.0 * sigma_m; }
};

/// Throws UsageError unless every number of `sensor` makes sense.
void require_valid(const BeamSensor& sensor);

/// What one beam may meet, nearest cell first. A value to be filled again and again.
struct BeamProfile {
  std::vector<int> cell;
  std::vector<double> occupancy;  ///< o_j in [0, 1]
  std::vector<double> enter_m;    ///< where cell j begins along the beam, ascending
  std::vector<double> exit_m;     ///< where it ends

  [[nodiscard]] int size() const { return static_cast<int>(occupancy.size()); }
  void clear();
  void push_back(int cell_index, double occupancy_probability, double from_m, double to_m);
};

/// Fills `out` with the cells that a beam from `from_m` may meet within the sensor's range. The
/// first cell is left out: the vehicle stands in it. Ends behind the first cell that is certainly
/// occupied. Allocates only while `out` grows.
void trace_beam(const OccupancyBelief& belief, const BeamSensor& sensor,
                const Eigen::Vector2d& from_m, double bearing_rad, BeamProfile& out);

}  // namespace vantage::models
