#pragma once

#include "models/mapping/occupancy_belief.hpp"
#include "test/support/random.hpp"

namespace vantage::test {

/// Returns a belief with patches of free, occupied, doubtful and unknown cells. Log odds are
/// clamped at 3.
inline models::OccupancyBelief random_map(Random& random, const models::GridGeometry& geometry,
                                          double occupied_share) {
  models::OccupancyBelief belief(geometry, 3.0);
  for (int cell = 0; cell < geometry.size(); ++cell) {
    const bool is_unknown_patch = (cell / 5 + cell / (5 * geometry.columns)) % 3 == 0;
    const double draw = random.uniform(0.0, 1.0);
    if (draw < occupied_share) {
      belief.add_log_odds(cell, 9.0);
    } else if (!is_unknown_patch) {
      belief.add_log_odds(cell, draw < 0.7 ? -9.0 : random.uniform(-3.0, 0.0));
    }
  }
  return belief;
}

}  // namespace vantage::test
