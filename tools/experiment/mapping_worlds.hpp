#pragma once

#include "models/world/world.hpp"

namespace vantage::experiment {

/// 24 × 24 m with sixteen square obstacles, 2 m wide, slightly off a regular lattice. The source's
/// own map is a picture without a scale. Source: dissertation Fig. 4.4, top row.
models::World square_obstacles_world();

/// 24 × 24 m of corridors 2.2 m and more wide around blocks and rooms with a door.
/// Source: dissertation Fig. 4.4, bottom row; ours, for the same reason.
models::World corridor_world();

}  // namespace vantage::experiment
