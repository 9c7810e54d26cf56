#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/mapping/mapping_spec.hpp"
#include "models/mapping/occupancy_belief.hpp"

namespace vantage::models {

/// The scan counts of a map: for each cell, the number of scans that hit something in the cell
/// minus the number of scans that passed through it. Sums of counts are independent of the order of
/// scans, unlike sums of clamped log-odds. Maps are therefore sent and merged as counts. Counts
/// saturate at the limits of int16_t, after hours of scans of one cell.
using CellCounts = std::vector<std::int16_t>;

/// Adds one scan of `cell` to its count.
void count_scan(CellCounts& counts, int cell, bool is_hit);
/// Returns the sums, cell by cell. Each sum is saturated only at the end, so the order of the maps
/// does not matter. Precondition: `all` has at least one map; all maps have the same size.
CellCounts sum_of(std::span<const std::span<const std::int16_t>> all);

/// Returns the belief for `counts`: the log-odds are the count times the log-odds of one hit,
/// clamped at the settled probability. Precondition: geometry.size() counts.
OccupancyBelief belief_of(const GridGeometry& geometry, std::span<const std::int16_t> counts,
                          const MappingSpec& spec);

/// Returns the grid that covers the world with the resolution of `spec`.
GridGeometry map_geometry(const World& world, const MappingSpec& spec);

}  // namespace vantage::models
