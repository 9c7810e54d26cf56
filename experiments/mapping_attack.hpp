#pragma once

#include <random>
#include <vector>

#include "planner/mapping/mapping_search.hpp"

namespace vantage::experiments {

enum class AttackKind {
  kNone,
  kRandom,     ///< every set of α robots is as likely
  kWorstCase,  ///< the robots whose loss costs the plans most, one after another
  kBestAlone,  ///< the robots whose plans alone are worth most: those that RTP expects to lose
  /// The worst case of the plans before, against those that follow: who attacks sees what the team
  /// did, not what it is about to do. Nobody is attacked along the first plans.
  kPreviousPlans,
};

/// The robots (by index, ascending) that will not see anything over the routes of this planning
/// duration; of kPreviousPlans over those of the next. The worst case is approximated greedily: the
/// next robot is that without which the value of those left is least (the first of equals). Source:
/// dissertation 4 F (attack models).
std::vector<int> attacked_robots(AttackKind kind, int attacks,
                                 const std::vector<planner::MapRoute>& routes,
                                 planner::MappingSearch& search, std::mt19937_64& random);

}  // namespace vantage::experiments
