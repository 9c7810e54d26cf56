#pragma once

#include <span>
#include <vector>

#include "planner/mapping/mapping_search.hpp"

namespace vantage::planner {

/// plan_resiliently() on the mapping objective; those outside the bait plan by coordinate descent.
/// Result by index of `starts`; robots keep apart (separation_m) from those only that they were
/// planned against. Source: dissertation Alg. 10.
std::vector<MapRoute> plan_mapping_resiliently(MappingSearch& search, std::span<const Pose2> starts,
                                               int attacks_max);

}  // namespace vantage::planner
