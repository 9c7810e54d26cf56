#pragma once

#include <vector>

#include "core/deadline.hpp"
#include "planner/decision/decision.hpp"

namespace vantage::planner {

/// Options of coordinate descent.
struct DescentOptions {
  /// order in which robots choose; empty: 0, 1, …; robots that are not listed get no candidate
  std::vector<int> order;
  /// maximum number of rounds; the search ends earlier after a round without change
  int rounds_max = 1;
  /// True: tries candidates by descending individual value and stops at the first with a value
  /// below the best gain found. The result does not change. Ignored unless the information is
  /// submodular.
  bool lazy = true;
};

/// Coordinate descent: each robot in turn chooses the candidate with the greatest positive gain,
/// given the choices of the robots before it; no candidate if no gain is positive. In later rounds
/// each robot chooses again with all others fixed; J never decreases. Of equal gains, it
/// prefers the candidate with the greater individual value, then the lowest id. For monotone
/// submodular J: J ≥ ½ J*, in any order. The deadline counts oracle calls as nodes. When it
/// expires, the current robot takes the best candidate found so far, or keeps its previous one if
/// that is better. Later robots keep their candidates.
/// Source: dissertation, sections 3.B and 3.D; Atanasov et al. 2015. Cost: ≤ N oracle calls per
/// round.
TeamDecision coordinate_descent(const TeamOracle& oracle, const DescentOptions& options,
                                const Deadline& deadline = Deadline::never());

/// Team-wide greedy: repeatedly adds the candidate with the greatest positive gain among robots
/// without one. It has the same bound as coordinate descent but needs no order of the robots. If
/// the information is submodular, gains from earlier iterations serve as upper bounds (Minoux).
TeamDecision greedy(const TeamOracle& oracle);

}  // namespace vantage::planner
