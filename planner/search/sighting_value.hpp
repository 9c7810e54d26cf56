#pragma once

#include <vector>

#include "core/pose.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/expander.hpp"

namespace vantage::planner {

/// What going for a target that is not in sight yet will bring: a guess that ranks nodes, no bound.
/// One look is taken to be worth, for ever, what it is from half the range half way through the
/// plan.
class SightingValue {
 public:
  explicit SightingValue(int targets_max) : look_values_(static_cast<std::size_t>(targets_max)) {}

  /// Tables `problem`, which must outlive the queries, as must `expander`, reset to it.
  void reset(const SearchProblem& problem, const Expander& expander);

  /// Most over the targets of (one look's value) × (steps from the first sighting to the end, when
  /// driven and turned there at full speed), from `pose` at depth t; nats, or m² for the trace.
  /// O(targets).
  [[nodiscard]] double value(const Pose2& pose, int t) const;

 private:
  const SearchProblem* problem_ = nullptr;
  const Expander* expander_ = nullptr;
  std::vector<double> look_values_;  ///< per target: what one look is worth, nats or m²
  double speed_max_mps_ = 0.0;
  double turn_max_radps_ = 0.0;
  double range_max_m_ = 0.0;
  double half_fov_rad_ = 0.0;
};

}  // namespace vantage::planner
