#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "planner/decision/team_oracle.hpp"

namespace vantage::planner {

/// Result and effort of a team decision.
struct TeamDecision {
  Choice choice;
  double value = 0.0;  ///< J, nats
  /// number of oracle calls, excluding those for single candidates (TeamOracle::calls())
  std::int64_t oracle_calls = 0;
  std::int64_t adopted = 0;    ///< adopted changes of the team's solution
  std::int64_t messages = 0;   ///< broadcasts of all robots, including empty proposals
  bool finished = true;        ///< false: the deadline expired first
  std::vector<Choice> optima;  ///< result of each round; empty unless a local search was used
};

/// Condition under which a local operation counts as an improvement: g' ≥ (1 + α/N⁴) g with g = J +
/// O ≥ 0, and a strict increase of J. For N above about 10⁴, α/N⁴ is below the resolution of a
/// double. With the first condition alone, the search could then cycle among equal solutions.
/// Source: dissertation Alg. 6 and eq. 3.18.
class ImprovementRule {
 public:
  /// @param alpha > 0
  /// @param least_rise ≥ 0, nats: smaller increases of J do not count
  ImprovementRule(const TeamOracle& oracle, double alpha, double least_rise = 0.0);
  /// True if J = `after` improves on J = `before`.
  [[nodiscard]] bool improves(double before, double after) const {
    return after > before && after >= before + least_rise_ &&
           after + offset_ >= factor_ * (before + offset_);
  }
  /// Returns the least J that improves on `before`, up to rounding.
  [[nodiscard]] double least(double before) const {
    return std::max(before + least_rise_, factor_ * (before + offset_) - offset_);
  }

 private:
  double factor_;
  double offset_;
  double least_rise_;
};

/// A local operation on the team's solution: deletion (d, NOP), addition (NOP, a) or swap (d, a).
struct Proposal {
  int drop_robot = -1;  ///< robot that loses its trajectory; −1: none
  CandidateId add = kNoCandidate;
  double value = 0.0;  ///< J after the operation, nats

  [[nodiscard]] bool is_nothing() const { return drop_robot < 0 && add == kNoCandidate; }
};

/// True if `a` precedes `b` in the tie rule that all robots share: greater value first; then the
/// lowest added candidate; last, a deletion without addition, with the lowest robot first. This is
/// a strict order of the proposals for one solution, so all robots adopt the same one whatever the
/// order of arrival.
bool is_preferred(const Proposal& a, const Proposal& b);

/// Returns `choice` after applying `proposal`.
Choice adopt(const TeamOracle& oracle, Choice choice, const Proposal& proposal);

}  // namespace vantage::planner
