#include "models/mapping/cell_counts.hpp"

#include <algorithm>
#include <functional>
#include <limits>

#include "core/check.hpp"
#include "core/index.hpp"

namespace vantage::models {
namespace {

std::int16_t limited(int count) {
  using Limits = std::numeric_limits<std::int16_t>;
  return static_cast<std::int16_t>(std::clamp<int>(count, Limits::min(), Limits::max()));
}

}  // namespace

void count_scan(CellCounts& counts, int cell, bool is_hit) {
  std::int16_t& count = counts[index(cell)];
  count = limited(count + (is_hit ? 1 : -1));
}

CellCounts sum_of(std::span<const std::span<const std::int16_t>> all) {
  require(!all.empty(), "the list of counts to add must not be empty");
  std::vector<int> sums(all.front().size(), 0);
  for (const std::span<const std::int16_t> counts : all) {
    require(counts.size() == sums.size(), "scan counts must have equal grids to be added");
    std::transform(sums.begin(), sums.end(), counts.begin(), sums.begin(), std::plus<>());
  }
  CellCounts limited_sums(sums.size());
  std::transform(sums.begin(), sums.end(), limited_sums.begin(), limited);
  return limited_sums;
}

OccupancyBelief belief_of(const GridGeometry& geometry, std::span<const std::int16_t> counts,
                          const MappingSpec& spec) {
  require(counts.size() == static_cast<std::size_t>(geometry.size()),
          "a map must have one observation count per cell");
  OccupancyBelief belief(geometry, log_odds_of(spec.settled_probability));
  const double hit_log_odds = log_odds_of(spec.look_probability);
  for (int cell = 0; cell < geometry.size(); ++cell) {
    const std::int16_t count = counts[index(cell)];
    if (count != 0) {
      belief.add_log_odds(cell, count * hit_log_odds);
    }
  }
  return belief;
}

GridGeometry map_geometry(const World& world, const MappingSpec& spec) {
  return GridGeometry::covering(world.bounds, spec.resolution_m);
}

}  // namespace vantage::models
