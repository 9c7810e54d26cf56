#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/plan/problem_json.hpp"

namespace vantage::bench {

/// Returns one problem of the tracking family of the public planning problems: a 64 × 64 m map
/// without obstacles, the robot at its centre, T = 12, the ten standard primitives, `targets`
/// double integrators (q 0.001, prior 1, 1, 0.1, 0.1) with means within ±20 m and ±0.5 m/s, range
/// and bearing to 10 m within a field of view of `fov_deg`, σ 0.15 m and 5°.
tools::PlanningProblem tracking_problem(int targets, std::uint64_t seed, double fov_deg = 94.0);

/// Returns a hundred problems: for each M in {1, 3, 9, 16, 25}, twenty problems with consecutive
/// seeds from `first_seed`. The planner study reports the problems from seed 1; settings are chosen
/// on problems with other seeds.
std::vector<tools::PlanningProblem> hundred_problems(double fov_deg = 94.0,
                                                     std::uint64_t first_seed = 1);

/// Adds the terminal value of a tour over the targets, with a horizon of 120 s.
void add_tour(planner::SearchProblem& problem);

}  // namespace vantage::bench
