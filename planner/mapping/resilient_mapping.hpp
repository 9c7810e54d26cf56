#pragma once

#include <span>
#include <vector>

#include "planner/mapping/mapping_search.hpp"

namespace vantage::planner {

/// Runs plan_resiliently() on the mapping objective; robots outside the bait plan by coordinate
/// descent. Result by index of `starts`. A robot keeps separation_m only from the robots with
/// routes that were fixed when it was planned. Source: dissertation Alg. 10.
std::vector<MapRoute> plan_mapping_resiliently(MappingSearch& search, std::span<const Pose2> starts,
                                               int attacks_max);

}  // namespace vantage::planner
