#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/deadline.hpp"
#include "planner/problem/belief_table.hpp"
#include "planner/search/lattice_bound.hpp"
#include "planner/search/linearised_cost.hpp"

namespace vantage::planner {

/// How much any paths of a team can be worth, whatever candidates the robots chose from: around a
/// reference, what all see together is additive over robots as well (LinearisedCost), so each
/// robot's best path over its own lattice (LatticeBound) bounds its part, and the reference moves
/// towards what those paths see together. Paths are any sequences of a robot's controls, one a
/// step; a robot may as well do nothing. Walls, teammates in the way and what motion costs are left
/// out: they only take away. Of spatial targets and other turns than LatticeBound takes nothing is
/// known.
///
/// Some 60 MB of memory are reserved. A turn of a robot is a lattice of 10⁵ to 10⁶ cells, 1 to 15
/// ms. Source: ours; Frank & Wolfe 1956.
class PathsBound {
 public:
  PathsBound(int targets_max, int horizon_max);

  struct Answer {
    double information_nats = 0.0;  ///< no paths give more; ∞: nothing is known
    std::vector<double> parts;      ///< of it, by robot, at the reference that it was found at
    std::int64_t work_nodes = 0;
  };
  /// The least that can be said of the paths of `robots` (numbers in `problems`) until `deadline`;
  /// all are of the same targets, horizon and step, their fixed information is not used.
  /// Precondition: `problems` are valid, with no more targets and steps than at construction.
  Answer of(std::span<const SearchProblem> problems, std::span<const int> robots,
            InformationMeasure measure, const Deadline& deadline);

  /// The same of what the worst attack on `attacks_max` of all robots leaves of any paths: no more
  /// than the others can bring when those with the largest parts are attacked. Half of `nodes` of
  /// work is for finding these. `parts` are of the others, ascending. `is_cancelled` as of
  /// Deadline::unless.
  Answer under_attack(std::span<const SearchProblem> problems, int attacks_max,
                      InformationMeasure measure, std::int64_t nodes,
                      bool (*is_cancelled)() = nullptr);

 private:
  LinearisedCost cost_;
  LatticeBound lattice_;
  BeliefTable beliefs_;
  std::vector<float> reference_;
  std::vector<float> looked_;
};

}  // namespace vantage::planner
