#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "planner/decision/team_oracle.hpp"

namespace vantage::planner {

/// What a team decided, and what that took.
struct TeamDecision {
  Choice choice;
  double value = 0.0;             ///< J, nats
  std::int64_t oracle_calls = 0;  ///< beyond the TeamOracle::calls() that valued each one alone
  std::int64_t adopted = 0;       ///< changes of the team's solution that were agreed on
  std::int64_t messages = 0;      ///< broadcasts of all robots, those that propose nothing included
  bool finished = true;           ///< false: the deadline came first
  std::vector<Choice> optima;     ///< of a local search: where each of its rounds ended
};

/// When a local operation counts as an improvement: g' ≥ (1 + α/N⁴) g with g = J + O ≥ 0, and a
/// strict rise of J besides, for α/N⁴ is below the resolution of a double from N ≈ 10⁴ on and the
/// first condition alone would then go in circles among equals.
/// Source: dissertation Alg. 6 and eq. 3.18.
class ImprovementRule {
 public:
  /// @param alpha > 0
  /// @param least_rise ≥ 0, nats: smaller rises of J do not count
  ImprovementRule(const TeamOracle& oracle, double alpha, double least_rise = 0.0);
  /// Whether J = `after` improves on J = `before`.
  [[nodiscard]] bool improves(double before, double after) const {
    return after > before && after >= before + least_rise_ &&
           after + offset_ >= factor_ * (before + offset_);
  }
  /// A J that everything that improves on `before` reaches, to rounding.
  [[nodiscard]] double least(double before) const {
    return std::max(before + least_rise_, factor_ * (before + offset_) - offset_);
  }

 private:
  double factor_;
  double offset_;
  double least_rise_;
};

/// A local operation on the team's solution: (d, NOP), (NOP, a) or (d, a).
struct Proposal {
  int drop_robot = -1;  ///< whose trajectory is deleted; −1: nobody's
  CandidateId add = kNoCandidate;
  double value = 0.0;  ///< J afterwards, nats

  [[nodiscard]] bool is_nothing() const { return drop_robot < 0 && add == kNoCandidate; }
};

/// The tie rule that all robots share: of two proposals the one of greater value; among equals the
/// one that adds the candidate of the lowest number, last a mere deletion of the lowest robot.
/// A strict order of proposals to one solution, so that all adopt the same one whatever the order
/// in which they arrive.
bool is_preferred(const Proposal& a, const Proposal& b);

/// `choice` after `proposal`.
Choice adopt(const TeamOracle& oracle, Choice choice, const Proposal& proposal);

}  // namespace vantage::planner
