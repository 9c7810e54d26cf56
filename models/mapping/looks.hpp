#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/mapping/mapping_spec.hpp"
#include "models/mapping/occupancy_belief.hpp"

namespace vantage::models {

/// What scans told of each cell, counted: those that met something in it less those that passed
/// through. Counts of different scans add up to the same whatever their order, unlike log-odds that
/// are clamped on the way; that is how a map travels and is merged. At the limits of int16_t (hours
/// at one cell) a count stays.
using Looks = std::vector<std::int16_t>;

/// One look more of `cell`.
void add_look(Looks& looks, int cell, bool met_something);
/// The sum of all, cell by cell, limited once: the same in any order. Precondition: at least one,
/// equal sizes.
Looks sum_of(std::span<const std::span<const std::int16_t>> all);

/// The belief that `looks` make: log-odds are looks · log-odds of one look, clamped to the settled
/// ones. Precondition: geometry.size() looks.
OccupancyBelief belief_of(const GridGeometry& geometry, std::span<const std::int16_t> looks,
                          const MappingSpec& spec);

/// The grid of `spec` over the world.
GridGeometry map_geometry(const World& world, const MappingSpec& spec);

}  // namespace vantage::models
