#pragma once

#include <cstdint>

namespace vantage::planner {

/// What happened besides the plan, since a planner's construction.
struct PlannerCounts {
  std::int64_t fallbacks_shifted = 0;
  std::int64_t fallbacks_braking = 0;
  std::int64_t off_plan = 0;       ///< vehicle farther from its plan than the tolerance
  std::int64_t checks_failed = 0;  ///< searched plans that the closing check refused
  std::int64_t turns_away = 0;     ///< at rest too near a teammate or a wall, with no way out ahead
  std::int64_t baits = 0;          ///< rounds in which this robot was bait
  std::int64_t rests = 0;          ///< rounds in which no motion was worth its energy
  std::int64_t yields = 0;         ///< rounds in which its slot was another's, or only claimed
  std::int64_t no_pose = 0;        ///< rounds without any idea of where the robot is
  std::int64_t unknown_plan = 0;   ///< rounds in which it flew a plan of before a restart
  /// Targets that cannot be predicted (of a clock that was ahead, say) or that the scenario has
  /// not, and grids of another geometry.
  std::int64_t unusable_beliefs = 0;
  std::int64_t bodies_dropped = 0;  ///< in the way of plans, and farther off than kBodiesMax others
  std::int64_t unusable_maps = 0;   ///< of another grid than the scenario's
  std::int64_t answers_refused = 0;  ///< that are no plan of their slot (motion_of_answer())
};

}  // namespace vantage::planner
