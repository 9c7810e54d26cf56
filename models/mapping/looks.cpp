#include "models/mapping/looks.hpp"

#include <algorithm>
#include <functional>
#include <limits>

#include "core/check.hpp"

namespace vantage::models {
namespace {

std::int16_t limited(int looks) {
  using Limits = std::numeric_limits<std::int16_t>;
  return static_cast<std::int16_t>(std::clamp<int>(looks, Limits::min(), Limits::max()));
}

}  // namespace

void add_look(Looks& looks, int cell, bool met_something) {
  std::int16_t& count = looks[static_cast<std::size_t>(cell)];
  count = limited(count + (met_something ? 1 : -1));
}

Looks sum_of(std::span<const std::span<const std::int16_t>> all) {
  require(!all.empty(), "the list of looks to add must not be empty");
  std::vector<int> sums(all.front().size(), 0);
  for (const std::span<const std::int16_t> looks : all) {
    require(looks.size() == sums.size(), "looks must have equal grids to be added");
    std::transform(sums.begin(), sums.end(), looks.begin(), sums.begin(), std::plus<>());
  }
  Looks limited_sums(sums.size());
  std::transform(sums.begin(), sums.end(), limited_sums.begin(), limited);
  return limited_sums;
}

OccupancyBelief belief_of(const GridGeometry& geometry, std::span<const std::int16_t> looks,
                          const MappingSpec& spec) {
  require(looks.size() == static_cast<std::size_t>(geometry.size()),
          "a map must have one observation count per cell");
  OccupancyBelief belief(geometry, log_odds_of(spec.settled_probability));
  const double look_log_odds = log_odds_of(spec.look_probability);
  for (int cell = 0; cell < geometry.size(); ++cell) {
    const std::int16_t count = looks[static_cast<std::size_t>(cell)];
    if (count != 0) {
      belief.add_log_odds(cell, count * look_log_odds);
    }
  }
  return belief;
}

GridGeometry map_geometry(const World& world, const MappingSpec& spec) {
  return GridGeometry::covering(world.bounds, spec.resolution_m);
}

}  // namespace vantage::models
