#pragma once

#include <cstdint>

namespace vantage::planner {

/// Counts of events since a planner's construction.
struct PlannerCounts {
  std::int64_t fallbacks_shifted = 0;
  std::int64_t fallbacks_braking = 0;
  std::int64_t off_plan = 0;       ///< vehicle was farther from its plan than the tolerance
  std::int64_t checks_failed = 0;  ///< searched plans rejected by the closing check
  std::int64_t turns_away = 0;     ///< turns on the spot, because a teammate or wall is ahead
  std::int64_t bait_rounds = 0;    ///< rounds in which this robot was bait
  std::int64_t rest_rounds = 0;    ///< rounds in which every motion cost more energy than it gained
  std::int64_t yielded_rounds = 0;  ///< rounds without a search because the slot is shared
  std::int64_t no_pose = 0;         ///< rounds without a known pose
  /// rounds in which the robot flew a plan that was made before a restart
  std::int64_t unknown_plan = 0;
  /// Targets that cannot be predicted (e.g. with a stamp from a clock that was ahead) or are not in
  /// the scenario, and grids with a geometry that differs from the scenario's.
  std::int64_t unusable_beliefs = 0;
  /// bodies in the way that were ignored because kBodiesMax nearer ones exist
  std::int64_t bodies_dropped = 0;
  std::int64_t unusable_maps = 0;    ///< maps with a grid that differs from the scenario's grid
  std::int64_t answers_refused = 0;  ///< answers that are not valid plans (motion_of_answer())
};

}  // namespace vantage::planner
