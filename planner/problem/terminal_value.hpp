#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace vantage::planner {

/// Expected cost after a plan's end, as a function of the plan's last position and of the targets
/// that the plan has measured. A search adds it to the cost of a complete plan.
///
/// A tour visits stops, each the position of one target. Every second until the arrival at stop i
/// costs `rate_i`. Let φ_i be the share of the work at stop i that remains after the plan's
/// measurements, and j the first stop in the order of the tour with φ_j > 0. Then
/// V(x, φ) = Σ_{i ≥ j} φ_i rate_i (t_j(x) + after_i − after_j), where t_j is the travel time to
/// stop j, and V = 0 if all φ_i are 0. t_j is interpolated bilinearly from a square grid, so a
/// query is O(1). Only the first kFieldsMax stops have a grid; for later stops t_j = 0.
///
/// φ_i = 1 if the target was not measured. Otherwise φ_i = (c − done_i) / (open_i − done_i),
/// limited to [0, 1], where c is the log det (or trace) of the target's covariance; φ_i = 0 if
/// done_i = open_i. So most of the work at a stop can remain after one distant measurement.
///
/// V ≥ 0. V does not increase if covariances are smaller or more targets are measured, because
/// travel times obey the triangle inequality at every grid point and interpolation preserves it.
/// Allocates only in its constructor.
class TerminalValue {
 public:
  static constexpr int kStopsMax = 64;
  static constexpr int kFieldsMax = 8;

  struct Stop {
    int target = 0;           ///< index into SearchProblem::targets; each target at most once
    double rate_per_s = 0.0;  ///< ≥ 0; cost of arriving one second later
    double after_s = 0.0;     ///< s, ascending; travel time from the first stop along the tour
    double open = 0.0;        ///< nat or m²; cost of the covariance at which φ = 1
    double done = 0.0;        ///< ≤ open; cost of the covariance at which φ = 0
  };

  /// Travel times to the first stops on a square grid.
  struct Fields {
    Eigen::Vector2d min_m = Eigen::Vector2d::Zero();  ///< position of the first grid point
    double cell_m = 1.0;
    int side = 0;                 ///< grid points per side, ≥ 2
    std::vector<double> times_s;  ///< [stop][row][column], min(stops, kFieldsMax) stops
  };

  TerminalValue() = default;
  /// @throws UsageError when an argument violates a rule stated above or is not finite
  TerminalValue(std::vector<Stop> stops, Fields fields);

  [[nodiscard]] bool is_empty() const { return stops_.empty(); }
  [[nodiscard]] const std::vector<Stop>& stops() const { return stops_; }

  /// The tour of the stops that are left: V(x) = offset + rate_per_s · t(field, x).
  struct Rest {
    double offset = 0.0;
    double rate_per_s = 0.0;
    int field = -1;  ///< index of the grid of travel times; −1: V does not depend on x
  };
  /// Returns the rest of the tour if φ = 0 at the stops of the targets `measured`. O(targets), and
  /// O(stops) if a stop is among them.
  [[nodiscard]] Rest rest(std::span<const std::uint16_t> measured) const {
    return rest(measured, [](std::size_t) { return -std::numeric_limits<double>::infinity(); });
  }
  /// Returns the rest of the tour after measurements of the targets `measured`. `cost_of(k)`
  /// returns the log det or trace of the covariance of measured[k]; it is called only for stops.
  template <class CostOf>
  [[nodiscard]] Rest rest(std::span<const std::uint16_t> measured, const CostOf& cost_of) const {
    double left[kStopsMax];
    bool has_changed = false;
    for (std::size_t k = 0; k < measured.size(); ++k) {
      const std::uint16_t m = measured[k];
      if (m < stop_of_.size() && stop_of_[m] >= 0) {
        if (!has_changed) {
          std::fill_n(left, stops_.size(), 1.0);
          has_changed = true;
        }
        const Stop& stop = stops_[static_cast<std::size_t>(stop_of_[m])];
        left[stop_of_[m]] =
            stop.done < stop.open
                ? std::clamp((cost_of(k) - stop.done) / (stop.open - stop.done), 0.0, 1.0)
                : 0.0;
      }
    }
    return has_changed ? rest_of(left) : whole_;
  }

  /// Returns V at `p_m`. O(1).
  [[nodiscard]] double at(const Rest& rest, const Eigen::Vector2d& p_m) const {
    return rest.field < 0 ? rest.offset : rest.offset + rest.rate_per_s * time_s(rest.field, p_m);
  }
  /// Returns a lower bound of V over all positions within `reach_m` of `p_m`. O(1).
  [[nodiscard]] double least_within(const Rest& rest, const Eigen::Vector2d& p_m,
                                    double reach_m) const;

  /// True if target m has a stop.
  [[nodiscard]] bool has_stop(int m) const {
    return m < target_count() && stop_of_[static_cast<std::size_t>(m)] >= 0;
  }
  /// Returns the largest index of a target plus 1.
  [[nodiscard]] int target_count() const { return static_cast<int>(stop_of_.size()); }

 private:
  [[nodiscard]] double time_s(int field, const Eigen::Vector2d& p_m) const;
  /// `left`: φ of each stop.
  [[nodiscard]] Rest rest_of(const double* left) const;
  void set_slopes();

  std::vector<Stop> stops_;
  Fields fields_;
  std::vector<double> slopes_s_per_m_;  ///< per field: largest slope of the interpolation
  std::vector<std::int8_t> stop_of_;    ///< per target: its stop; −1 if it has none
  Rest whole_;                          ///< rest of the tour without measurements
};

}  // namespace vantage::planner
