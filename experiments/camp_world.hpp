#pragma once

#include <cstdint>
#include <vector>

#include "models/sensor/sensor.hpp"
#include "models/world/world.hpp"

namespace vantage::experiments {

/// A camp of 120 × 90 m to watch over: fifteen buildings of 3 to 9 m about a parade ground, and two
/// dozen trees along its roads, each a pillar of 1.5 m. Boxes all, as obstacles are. The buildings
/// come first. Ours: the source's camp is not public, its picture has no scale.
/// Source: dissertation Fig. 4.6.
models::World camp_world();

/// One landmark for each building, a metre above the middle of its roof.
std::vector<models::PositionVector> camp_landmarks_m();

/// Heights that robots fly at: 5.5 m and a metre more for each, so that none meets another.
double camp_height_m(int robot);

}  // namespace vantage::experiments
