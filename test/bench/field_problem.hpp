#pragma once

#include <cstdint>

#include "planner/problem/owned_problem.hpp"

namespace vantage::bench {

/// Returns one problem of the field family. The map is 64 × 64 m without obstacles; with more than
/// 25 targets it is larger, at the same density. The robot starts at the origin and has the ten
/// standard primitives. The `targets` double integrators (q 0.001, prior 1, 1, 0.1, 0.1) are
/// anywhere in the map and move at about 0.5 m/s. The sensor measures range and bearing to 10 m
/// within 94°, σ 0.15 m and 5°.
planner::SearchProblem field_problem(int targets, int horizon_steps, std::uint64_t seed);

/// Returns a field problem with `obstacles` boxes with sides of 0.5–3 m within 20 m of the start
/// and at least 1 m from it, a robot of radius 0.2 m, and a distance field of 0.1 m cells. Without
/// boxes, the problem has no world.
planner::OwnedProblem obstructed_problem(int targets, int horizon_steps, int obstacles,
                                         std::uint64_t seed);

}  // namespace vantage::bench
