#pragma once

#include <vector>

#include "core/pose.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/expander.hpp"

namespace vantage::planner {

/// Heuristic value of approaching a target that is not yet visible. It ranks nodes and is not a
/// bound. Assumes that every measurement gains as much as one from half the range at half the
/// horizon.
class SightingValue {
 public:
  explicit SightingValue(int targets_max) : look_values_(static_cast<std::size_t>(targets_max)) {}

  /// Tabulates `problem`. Call expander.reset(problem) first. Both arguments must outlive the
  /// queries.
  void reset(const SearchProblem& problem, const Expander& expander);

  /// Returns, from `pose` at depth t, the maximum over the targets of (gain of one measurement) ×
  /// (steps from the first sighting to the end); nats, or m² for the trace. Assumes driving and
  /// turning at full speed. O(targets).
  [[nodiscard]] double value(const Pose2& pose, int t) const;

 private:
  const SearchProblem* problem_ = nullptr;
  const Expander* expander_ = nullptr;
  std::vector<double> look_values_;  ///< per target: gain of one measurement, nats or m²
  double speed_max_mps_ = 0.0;
  double turn_max_radps_ = 0.0;
  double range_max_m_ = 0.0;
  double half_fov_rad_ = 0.0;
};

}  // namespace vantage::planner
