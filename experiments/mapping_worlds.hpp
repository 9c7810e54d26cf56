#pragma once

#include "models/world/world.hpp"

namespace vantage::experiments {

/// A square room with sixteen square obstacles, a twelfth of its side wide, slightly off a regular
/// lattice. The source's own map is a picture without a scale, nearly finished after 50 steps: at
/// 16 m that is so here. Source: dissertation Fig. 4.4, top row.
models::World square_obstacles_world(double side_m = 16.0);

/// Corridors, an eighth of the side wide, around two blocks and two rooms with a door.
/// Source: dissertation Fig. 4.4, bottom row; ours, for the same reason.
models::World corridor_world(double side_m = 16.0);

}  // namespace vantage::experiments
