#include "models/mapping/looks.hpp"

#include <algorithm>
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

void add_looks(Looks& a, std::span<const std::int16_t> b) {
  require(a.size() == b.size(), "looks of different grids cannot be added");
  std::transform(a.begin(), a.end(), b.begin(), a.begin(),
                 [](int x, int y) { return limited(x + y); });
}

OccupancyBelief belief_of(const GridGeometry& geometry, std::span<const std::int16_t> looks,
                          const MappingSpec& spec) {
  require(looks.size() == static_cast<std::size_t>(geometry.size()),
          "a map must have one count of looks a cell");
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
