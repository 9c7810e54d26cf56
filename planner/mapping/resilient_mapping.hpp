#pragma once

#include <span>
#include <vector>

#include "planner/mapping/mapping_search.hpp"

namespace vantage::planner {

/// Robust trajectory planning on the mapping objective: each robot plans alone; the `attacks_max`
/// whose plans alone are worth most are the bait and keep them; the rest plan by coordinate
/// descent, by number, as if the bait did not exist. With `attacks_max` = 0 it is coordinate
/// descent. Result by index of `starts`; robots keep apart (separation_m) from those only that
/// they were planned against. Source: dissertation Alg. 10.
std::vector<MapRoute> plan_mapping_resiliently(MappingSearch& search, std::span<const Pose2> starts,
                                               int attacks_max);

}  // namespace vantage::planner
