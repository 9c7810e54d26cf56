#pragma once

#include <cstdint>

#include "core/deadline.hpp"
#include "planner/search/heuristic.hpp"
#include "planner/search/sequencing_bound.hpp"

namespace vantage::planner {

/// What no plan can cost less than.
struct RootBounds {
  double any_plan = 0.0;     ///< Thm 6: also one that stops and hovers on the way
  double moving_plan = 0.0;  ///< every step taken from the controls; ≥ any_plan
};

/// The certificate for searches that have none of their own (ARVI, RVI, beams): bounds at the root,
/// in 10–100 µs for Thm 6 and up to `states_max` / 3 µs more for the sequence of looks.
/// Allocates nothing after construction.
class RootBound {
 public:
  RootBound(int targets_max, int horizon_max, int states_max = 4'000);

  /// `beliefs` are those of `problem`; both must outlive the call alone. When the deadline comes,
  /// what is bounded so far. Adds to `work_nodes` what it expands.
  RootBounds of(const SearchProblem& problem, const BeliefTable& beliefs, const Deadline& deadline,
                std::int64_t& work_nodes);

 private:
  InformationHeuristic heuristic_;
  SequencingBound sequencing_;
};

}  // namespace vantage::planner
