#pragma once

#include <random>
#include <vector>

#include "planner/mapping/mapping_search.hpp"

namespace vantage::experiments {

enum class AttackKind {
  kNone,
  kRandom,     ///< every set of α robots is equally likely
  kWorstCase,  ///< the attack that reduces the value most, chosen greedily
  kBestAlone,  ///< the robots with the best individual plans, which are the bait
  /// The worst-case attack on the previous plans, applied during the current ones: the attacker
  /// knows only past motion, not the next plans. No robot is attacked during the first plans.
  kPreviousPlans,
};

/// Returns the robots (indices, ascending) that are attacked while the routes of this planning
/// period are driven; for kPreviousPlans, while the routes of the next period are driven. The worst
/// case is approximated greedily: each step adds the robot without which the value of the remaining
/// robots is least. If several robots qualify, it adds the one with the lowest index.
/// Source: dissertation, section 4.F (attack models).
std::vector<int> attacked_robots(AttackKind kind, int attacks,
                                 const std::vector<planner::MapRoute>& routes,
                                 planner::MappingSearch& search, std::mt19937_64& random);

}  // namespace vantage::experiments
