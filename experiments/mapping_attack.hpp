#pragma once

#include <random>
#include <vector>

#include "planner/mapping/mapping_search.hpp"

namespace vantage::experiments {

enum class AttackKind {
  kNone,
  kRandom,     ///< every set of α robots is equally likely
  kWorstCase,  ///< the robots with the most costly loss, chosen greedily
  kBestAlone,  ///< the robots with the best plans alone, which are those that RTP expects to lose
  /// The worst case of the previous plans, applied to the current ones: the attacker observes what
  /// the team did, not its next plans. No robot is attacked during the first plans.
  kPreviousPlans,
};

/// Returns the robots (indices, ascending) that are attacked during the routes of this planning
/// period; for kPreviousPlans during those of the next. The worst case is approximated greedily:
/// the next robot is the one without which the value of the remaining ones is least (the first of
/// equals).
/// Source: dissertation 4 F (attack models).
std::vector<int> attacked_robots(AttackKind kind, int attacks,
                                 const std::vector<planner::MapRoute>& routes,
                                 planner::MappingSearch& search, std::mt19937_64& random);

}  // namespace vantage::experiments
