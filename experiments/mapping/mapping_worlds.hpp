#pragma once

#include "models/world/world.hpp"

namespace vantage::experiments {

/// Returns a square room with sixteen square obstacles, each a twelfth of its side wide, slightly
/// off a regular lattice. In the dissertation the map is a picture without a scale, and it is
/// almost complete after 50 steps. With a side of 16 m the same holds here.
/// Source: dissertation Fig. 4.4, top row.
models::World square_obstacles_world(double side_m = 16.0);

/// Returns corridors, an eighth of the side wide, around two solid blocks and two rooms with a door
/// each. The layout is our choice, because the dissertation's picture has no scale.
/// Source: dissertation Fig. 4.4, bottom row.
models::World corridor_world(double side_m = 16.0);

}  // namespace vantage::experiments
