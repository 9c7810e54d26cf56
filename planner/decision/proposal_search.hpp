#pragma once

#include <span>
#include <vector>

#include "planner/decision/decision.hpp"
#include "planner/decision/team_set.hpp"

namespace vantage::planner {

/// One robot's search for a local operation with its own candidates, one oracle call at a time: it
/// can be left whenever a teammate's proposal or the end of a slot comes first.
///
/// Order: additions, then for the robot's own trajectory and each teammate's by number the deletion
/// and the swaps with it. Lazily (submodular J): candidates are tried from the best alone on, and
/// given up once J({a}) is below what has to be gained, for no later one can gain it either.
/// Source: dissertation Alg. 8, with deletion proposed for d ≠ NOP only.
class ProposalSearch {
 public:
  enum class State { kSearching, kProposes, kNothing };

  /// All of `oracle` and `rule` must outlive this.
  ProposalSearch(const TeamOracle& oracle, const ImprovementRule& rule, int robot, bool lazy);

  /// Starts again about the team's solution, of value J = `value`. `excluded` marks the candidates
  /// that are out of the ground set and must live until the next begin().
  void begin(const Choice& choice, double value, std::span<const char> excluded);

  /// At most one oracle call more.
  State advance();

  /// After kProposes.
  [[nodiscard]] const Proposal& proposal() const { return proposal_; }
  [[nodiscard]] std::int64_t calls() const { return team_.calls(); }

 private:
  [[nodiscard]] CandidateId chosen_by(int robot) const {
    return choice_[static_cast<std::size_t>(robot)];
  }
  /// Turns to the next d; false when there is none. Asks for the deletion's value unless d = NOP.
  bool turn_to_next_deletion();
  void end_additions();
  State propose(CandidateId add, double value);

  const TeamOracle* oracle_;
  const ImprovementRule* rule_;
  int robot_;
  bool lazy_;
  TeamSet team_;  ///< S⁻ while additions are tried, S otherwise
  std::vector<CandidateId> order_;
  std::span<const char> excluded_;
  Choice choice_;
  double value_ = 0.0;
  int turn_ = 0;  ///< of deletions: NOP, the robot's own, the teammates'
  int drop_robot_ = -1;
  bool is_adding_ = false;
  std::size_t next_addition_ = 0;
  double needed_ = 0.0;  ///< Δ
  Proposal proposal_;
};

}  // namespace vantage::planner
