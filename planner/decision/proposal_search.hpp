#pragma once

#include <span>
#include <vector>

#include "core/index.hpp"
#include "planner/decision/decision.hpp"
#include "planner/decision/team_set.hpp"

namespace vantage::planner {

/// One robot's search for a local operation with its own candidates, one oracle call at a time. It
/// can be interrupted at any call, when a teammate's proposal arrives or the slot ends.
///
/// Order of the operations: first all additions; then, for each trajectory (this robot's first,
/// then those of teammates by number), its deletion and the swaps that replace it. Lazy mode
/// (submodular J): candidates are tried by descending individual value until J({a}) is below the
/// required gain. Later candidates cannot reach this gain either.
/// Source: dissertation Alg. 8, with deletion proposed for d ≠ NOP only.
class ProposalSearch {
 public:
  enum class State { kSearching, kProposes, kNothing };

  /// `oracle` and `rule` must outlive this object.
  ProposalSearch(const TeamOracle& oracle, const ImprovementRule& rule, int robot, bool lazy);

  /// Restarts from the team's solution `choice`, which has the value J = `value`. `excluded` marks
  /// candidates removed from the ground set; it must stay valid until the next begin().
  void begin(const Choice& choice, double value, std::span<const char> excluded);

  /// Makes at most one more oracle call.
  State advance();

  /// Returns the proposal, after advance() returned kProposes.
  [[nodiscard]] const Proposal& proposal() const { return proposal_; }
  [[nodiscard]] std::int64_t calls() const { return team_.calls(); }

 private:
  [[nodiscard]] CandidateId chosen_by(int robot) const { return choice_[index(robot)]; }
  /// Advances to the next deletion d; false if there is none. Evaluates the deletion unless d =
  /// NOP.
  bool turn_to_next_deletion();
  void end_additions();
  State propose(CandidateId add, double value);

  const TeamOracle* oracle_;
  const ImprovementRule* rule_;
  int robot_;
  bool lazy_;
  TeamSet team_;  ///< the set S⁻ while additions are tried, otherwise the set S
  std::vector<CandidateId> order_;
  std::span<const char> excluded_;
  Choice choice_;
  double value_ = 0.0;
  /// index of the deletion: first none (NOP), then this robot's, then those of teammates
  int turn_ = 0;
  int drop_robot_ = -1;
  bool is_adding_ = false;
  std::size_t next_addition_ = 0;
  double needed_ = 0.0;  ///< Δ, the required gain
  Proposal proposal_;
};

}  // namespace vantage::planner
