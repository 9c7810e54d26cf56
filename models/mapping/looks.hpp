#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/mapping/mapping_spec.hpp"
#include "models/mapping/occupancy_belief.hpp"

namespace vantage::models {

/// The look counts of a map: for each cell, the number of scans that hit something in it minus the
/// number that passed through it. Sums of counts are independent of the order of scans, unlike sums
/// of clamped log-odds. Maps are therefore sent and merged as counts. Counts saturate at the limits
/// of int16_t, after hours of scans of one cell.
using Looks = std::vector<std::int16_t>;

/// Adds one look to the count of `cell`.
void add_look(Looks& looks, int cell, bool met_something);
/// Returns the sums, cell by cell. Each sum is saturated only at the end, so the order of the maps
/// does not matter. Precondition: at least one map, equal sizes.
Looks sum_of(std::span<const std::span<const std::int16_t>> all);

/// Returns the belief for `looks`: the log-odds are the count times the log-odds of one look,
/// clamped at the settled probability. Precondition: geometry.size() looks.
OccupancyBelief belief_of(const GridGeometry& geometry, std::span<const std::int16_t> looks,
                          const MappingSpec& spec);

/// Returns the grid of `spec` over the world.
GridGeometry map_geometry(const World& world, const MappingSpec& spec);

}  // namespace vantage::models
