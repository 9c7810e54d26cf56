#pragma once

#include <cstdint>
#include <vector>

#include "core/deadline.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/arvi.hpp"

// Baseline planners for comparison. As in the other searches, plans do not collide with obstacles
// or teammates and end with a safe stop.

namespace vantage::planner {

struct RandomWalkOptions {};

/// Planner that chooses a uniformly random feasible control at each step, seeded by the problem;
/// backtracks from dead ends. Allocates memory. Ignores deadlines, but makes at most 5000 tries.
class RandomWalk {
 public:
  explicit RandomWalk(const SearchCapacity& /*capacity*/) {}
  const SearchResult& plan(const SearchProblem& problem, const RandomWalkOptions& options,
                           const Deadline& deadline);

 private:
  SearchResult result_;
};

/// The strip of the world that one robot sweeps.
struct SweepShare {
  int index = 0;  ///< index of the strip among `count` strips
  int count = 1;
};

/// Planner that follows the waypoints of a lawn-mower sweep with a two-step look-ahead; rows are
/// 1.6 ranges of the first sensor apart. Stores its progress, so each robot needs a separate
/// object. Allocates memory. Ignores deadlines, but makes at most 5000 tries. plan() throws
/// UsageError when the problem has no world.
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

/// Returns the waypoints of a lawn-mower sweep of robot `index` of `count`: the world's longer side
/// is cut into `count` strips, each swept back and forth in rows `spacing_m` apart.
std::vector<Eigen::Vector2d> lawn_mower_waypoints(const models::Rectangle& bounds, int index,
                                                  int count, double spacing_m, double margin_m);

}  // namespace vantage::planner
