#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/deadline.hpp"
#include "planner/problem/belief_table.hpp"
#include "planner/search/lattice_bound.hpp"
#include "planner/search/linearised_cost.hpp"

namespace vantage::planner {

/// Upper bound of the team's information over all paths, independent of candidate sets. Around a
/// reference, the team's joint information is additive over robots (LinearisedCost). The best path
/// over a robot's own lattice (LatticeBound) therefore bounds the robot's share. In each iteration
/// the reference moves towards the joint information of these best paths. A path is any sequence of
/// a robot's controls, one per step; a robot may also stay without measuring. Walls, separation
/// from teammates and motion costs are ignored, since they only reduce the value. Gives no bound
/// for spatial targets, or for controls with turns that LatticeBound does not support.
///
/// Reserves about 60 MB of memory. One iteration per robot uses a lattice of 10⁵ to 10⁶ cells and
/// takes 1 to 15 ms. Source: ours; Frank & Wolfe 1956.
class PathsBound {
 public:
  PathsBound(int targets_max, int horizon_max);

  struct Answer {
    double information_nats = 0.0;  ///< upper bound for all paths; ∞: no bound found
    std::vector<double> parts;      ///< share of each robot in the best bound
    std::int64_t work_nodes = 0;
  };
  /// Returns the smallest bound for the paths of `robots` (indices into `problems`) found until
  /// `deadline`. All problems have the same targets, horizon and step; their fixed information is
  /// ignored. Precondition: `problems` are valid and within the targets and steps given to the
  /// constructor.
  Answer of(std::span<const SearchProblem> problems, std::span<const int> robots,
            InformationMeasure measure, const Deadline& deadline);

  /// Returns an upper bound of the information of any paths when the worst `attacks_max` robots are
  /// attacked. The first half of `nodes` bounds the information of all robots. Then the robots with
  /// the largest `parts` are assumed to be attacked, and the second half bounds the information of
  /// the others. The answer's `parts` are the shares of these others, by ascending index.
  /// `is_cancelled` is as in Deadline::unless.
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
