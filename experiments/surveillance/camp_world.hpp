#pragma once

#include <cstdint>
#include <vector>

#include "models/sensor/sensor.hpp"
#include "models/world/world.hpp"

namespace vantage::experiments {

/// Returns a camp of 120 × 90 m for surveillance: fifteen buildings of 3 to 9 m around a parade
/// ground, and two dozen trees along its roads, each with a base of 1.5 m × 1.5 m. Buildings and
/// trees are boxes; the buildings are first in the list. The layout is our choice, because the
/// dissertation's camp is not public and its picture has no scale.
/// Source: dissertation Fig. 4.6.
models::World camp_world();

/// Returns one landmark per building, 1 m above the middle of its roof.
std::vector<models::PositionVector> camp_landmarks_m();

/// Returns the flight height of a robot, m: 5.5 m plus 1 m per robot, so that robots cannot
/// collide.
double camp_height_m(int robot);

}  // namespace vantage::experiments
