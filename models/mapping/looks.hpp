#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/mapping/mapping_spec.hpp"
#include "models/mapping/occupancy_belief.hpp"

namespace vantage::models {

/// Scan count per cell: number of scans that hit something in it minus the number that passed
/// through it. Sums of counts do not depend on the order of the scans, unlike log-odds that are
/// clamped after each scan. Maps are therefore sent and merged as counts. A count saturates at the
/// limits of int16_t (hours at one cell).
using Looks = std::vector<std::int16_t>;

/// Adds one observation of `cell`: +1 for a hit, −1 for a pass.
void add_look(Looks& looks, int cell, bool met_something);
/// Returns the sum of all counts per cell, limited once at the end, so the result does not depend
/// on the order. Precondition: at least one, equal sizes.
Looks sum_of(std::span<const std::span<const std::int16_t>> all);

/// Returns the occupancy belief of `looks`: count · log-odds of one look, clamped to the log-odds
/// of settled_probability. Precondition: geometry.size() looks.
OccupancyBelief belief_of(const GridGeometry& geometry, std::span<const std::int16_t> looks,
                          const MappingSpec& spec);

/// Returns the grid of `spec` that covers the world's bounds.
GridGeometry map_geometry(const World& world, const MappingSpec& spec);

}  // namespace vantage::models
