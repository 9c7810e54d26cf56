#pragma once

#include <cstdint>
#include <vector>

#include "core/deadline.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/arvi.hpp"

// Planners that do not think, to be compared with. They obey the same rules as the search: free of
// obstacles and teammates, ending in a safe stop.

namespace vantage::planner {

struct RandomWalkOptions {};

/// A uniformly random feasible control at each step, drawn by the problem's seed; dead ends are
/// backed out of. Allocates; takes no notice of deadlines (5000 tries at most).
class RandomWalk {
 public:
  explicit RandomWalk(const SearchCapacity& /*capacity*/) {}
  const SearchResult& plan(const SearchProblem& problem, const RandomWalkOptions& options,
                           const Deadline& deadline);

 private:
  SearchResult result_;
};

/// Which part of the world a robot sweeps.
struct SweepShare {
  int index = 0;  ///< of `count` strips
  int count = 1;
};

/// Controls that lead nearest to the way points of a lawn-mower sweep, one after another, by a
/// short look-ahead at each step: rows 1.6 ranges of the first sensor apart. Remembers how far it
/// has got, so each robot has its own. Allocates; takes no notice of deadlines (5000 tries at
/// most). plan() throws UsageError when the problem has no world.
class LawnMower {
 public:
  explicit LawnMower(const SearchCapacity& /*capacity*/) {}
  const SearchResult& plan(const SearchProblem& problem, const SweepShare& share,
                           const Deadline& deadline);

 private:
  std::vector<Eigen::Vector2d> waypoints_;
  std::size_t next_ = 0;
  SearchResult result_;
};

/// Way points of a lawn-mower sweep of robot `index` of `count`: the world's longer side is cut
/// into `count` strips, each swept in rows `spacing_m` apart, there and back again.
std::vector<Eigen::Vector2d> lawn_mower_waypoints(const models::Rectangle& bounds, int index,
                                                  int count, double spacing_m, double margin_m);

}  // namespace vantage::planner
