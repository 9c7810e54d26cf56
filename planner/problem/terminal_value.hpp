#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace vantage::planner {

/// Expected cost after a plan's end, as a function of the plan's last position and of the targets
/// that the plan has measured. A search adds it to the cost of a complete plan.
///
/// A tour visits stops, each the position of one target. Every second until the arrival at stop i
/// costs `rate_i`. Let U be the stops whose targets were not measured and j the first of them in
/// the order of the tour. Then V(x, U) = Σ_{i ∈ U} rate_i (t_j(x) + after_i − after_j), where t_j
/// is the travel time to stop j, and V = 0 if U is empty. t_j is interpolated bilinearly from a
/// square grid, so a query is O(1). Only the first kFieldsMax stops have a grid; for later stops
/// t_j = 0.
///
/// V ≥ 0. V does not increase if more targets are measured, because travel times obey the triangle
/// inequality at every grid point and interpolation preserves it. Allocates only in its
/// constructor.
class TerminalValue {
 public:
  static constexpr int kStopsMax = 64;
  static constexpr int kFieldsMax = 8;

  struct Stop {
    int target = 0;           ///< index into SearchProblem::targets; each target at most once
    double rate_per_s = 0.0;  ///< ≥ 0; cost of arriving one second later
    double after_s = 0.0;     ///< s, ascending; travel time from the first stop along the tour
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
  /// Returns the rest of the tour after measurements of the targets `measured`. O(targets), and
  /// O(stops) if a stop is among them.
  [[nodiscard]] Rest rest(std::span<const std::uint16_t> measured) const;

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
  [[nodiscard]] Rest rest_without(std::uint64_t visited) const;
  void set_slopes();

  std::vector<Stop> stops_;
  Fields fields_;
  std::vector<double> slopes_s_per_m_;  ///< per field: largest slope of the interpolation
  std::vector<std::int8_t> stop_of_;    ///< per target: its stop; −1 if it has none
  Rest whole_;                          ///< rest of the tour without measurements
};

}  // namespace vantage::planner
