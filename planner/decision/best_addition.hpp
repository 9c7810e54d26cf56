#pragma once

#include <span>
#include <vector>

#include "planner/decision/decision.hpp"
#include "planner/decision/team_set.hpp"

namespace vantage::planner {

/// Finder of one robot's best candidate for a team solution. Candidates are added to the solution
/// and never removed.
///
/// Lazy mode: gains computed for earlier, smaller solutions are upper bounds of the present gains,
/// so only candidates that may still be best are evaluated (Minoux's accelerated greedy). Correct
/// for submodular J only.
class BestAddition {
 public:
  /// `oracle` must outlive this object.
  BestAddition(const TeamOracle& oracle, int robot, bool lazy);

  /// Returns the candidate with the greatest gain for `team`, even if the gain is not positive; no
  /// proposal if no candidate exists. `excluded` marks candidates to skip, by id; empty: none.
  /// If gains are equal, prefers the lowest id. Precondition: the robot has no candidate in `team`,
  /// and `team` contains the sets of all earlier calls.
  Proposal find(TeamSet& team, std::span<const char> excluded);

 private:
  struct Bound {
    double gain = 0.0;
    CandidateId id = kNoCandidate;
    /// Heap order: greatest gain first, then the lowest id.
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
