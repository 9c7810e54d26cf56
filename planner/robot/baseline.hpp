#pragma once

#include <cstdint>
#include <vector>

#include "planner/problem/motion_table.hpp"
#include "planner/problem/problem.hpp"

// Planners that do not think, to be compared with. They obey the same rules as the search: free of
// obstacles and teammates, ending in a safe stop.

namespace vantage::planner {

/// A uniformly random feasible control at each step, drawn by `seed`; dead ends are backed out of.
SearchResult plan_random_walk(const SearchProblem& problem, std::uint64_t seed);

/// Way points of a lawn-mower sweep of robot `index` of `count`: the world's longer side is cut
/// into `count` strips, each swept in rows `spacing_m` apart, there and back again.
std::vector<Eigen::Vector2d> lawn_mower_waypoints(const models::Rectangle& bounds, int index,
                                                  int count, double spacing_m, double margin_m);

/// Controls that lead nearest to the way points, one after another from `next` on, by a short
/// look-ahead at each step; `next` is moved on as they are reached.
SearchResult plan_through(const SearchProblem& problem,
                          const std::vector<Eigen::Vector2d>& waypoints, std::size_t& next);

}  // namespace vantage::planner
