#pragma once

#include <random>
#include <vector>

#include "core/pose.hpp"
#include "models/mapping/beam.hpp"
#include "models/world/world.hpp"

namespace vantage::models {

/// Returns the exact distance from `from_m` along `bearing_rad` to the first obstacle or wall; 0
/// inside an obstacle or outside the bounds. Closed form, O(obstacles). The function uses no grid,
/// so simulated scans have no discretisation errors of the map's grid.
double ray_distance_m(const World& world, const Eigen::Vector2d& from_m, double bearing_rad);

/// Returns one reading of every beam from `world_from_body`: N(mean_range_m(distance), σ²).
/// Source: dissertation, eq. 4.13.
std::vector<double> beam_scan(const World& world, const BeamSensor& sensor,
                              const Pose2& world_from_body, std::mt19937_64& random);

}  // namespace vantage::models
