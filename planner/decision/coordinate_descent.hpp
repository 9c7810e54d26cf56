#pragma once

#include <vector>

#include "core/deadline.hpp"
#include "planner/decision/decision.hpp"

namespace vantage::planner {

/// How robots choose one after another.
struct DescentOptions {
  std::vector<int> order;  ///< robots as they choose; empty: 0, 1, 2, …; others choose nothing
  int rounds_max = 1;  ///< turns of everybody; it ends earlier when a whole turn changes nothing
  /// Candidates are tried from the best alone on, and those whose value alone is below the best
  /// gain found are not asked for: the same choice, and sound for submodular information only.
  bool lazy = true;
};

/// Coordinate descent: each robot in turn takes the candidate that adds most to what those before
/// it took, or none where every one would take away. Later rounds let each choose again with all
/// others fixed; J never falls. Ties go to the better one alone, then to the lowest number.
/// For monotone submodular J: J ≥ ½ J*, in every order. The deadline counts oracle calls as nodes;
/// when it comes the robot whose turn it is takes the best it has found, or keeps what it had if
/// that was better, and those after it keep what they have.
/// Source: dissertation 3 B and D; Atanasov et al. 2015. Cost: ≤ N oracle calls a round.
TeamDecision coordinate_descent(const TeamOracle& oracle, const DescentOptions& options,
                                const Deadline& deadline = Deadline::never());

/// Greedy over the whole team: again and again the candidate of any robot without one that adds
/// most, while that is something. The same bound; needs no order. Lazily by stale gains (Minoux)
/// where information is submodular.
TeamDecision greedy(const TeamOracle& oracle);

}  // namespace vantage::planner
