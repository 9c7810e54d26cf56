#pragma once

#include <span>
#include <vector>

#include "planner/decision/decision.hpp"
#include "planner/decision/team_set.hpp"

namespace vantage::planner {

/// One robot's best candidate to add to a solution that only grows.
///
/// Lazily: gains of earlier, smaller solutions bound what a candidate adds now, so that only those
/// are asked for that may still be best (Minoux's accelerated greedy). Sound for submodular J.
class BestAddition {
 public:
  /// `oracle` must outlive this.
  BestAddition(const TeamOracle& oracle, int robot, bool lazy);

  /// The candidate that adds most to `team`, not among those marked in `excluded` (by candidate;
  /// empty: none), whether or not that is anything; nothing when there is none. Ties: the lowest
  /// number. Precondition: the robot has none in `team`, which holds all of earlier calls' sets.
  Proposal find(TeamSet& team, std::span<const char> excluded);

 private:
  struct Bound {
    double gain = 0.0;
    CandidateId id = kNoCandidate;
    /// Heap order: the greatest gain first, the lowest number among equals.
    friend bool operator<(const Bound& a, const Bound& b) {
      return a.gain < b.gain || (a.gain == b.gain && a.id > b.id);
    }
  };
  Proposal find_among_all(TeamSet& team, std::span<const char> excluded) const;

  const TeamOracle* oracle_;
  int robot_;
  bool lazy_;
  std::vector<Bound> heap_;
};

}  // namespace vantage::planner
