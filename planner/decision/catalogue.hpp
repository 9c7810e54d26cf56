#pragma once

#include <string_view>
#include <vector>

#include "core/deadline.hpp"
#include "planner/decision/decision.hpp"
#include "planner/decision/team_oracle.hpp"

namespace vantage::planner {

/// Options of team algorithms; each algorithm uses those that it names in `options`.
struct DecisionOptions {
  int attacks_max = 0;     ///< number of jammed robots that the decision must tolerate
  std::vector<int> order;  ///< coordinate descent: order of the robots; empty: 0, 1, 2, …
  int rounds_max = 1;      ///< coordinate descent: number of rounds
  double alpha = 1.0;      ///< local search: α; minimum gain factor 1 + α/N⁴, N candidates
};

/// One entry of the table of team algorithms, which choose among the candidates of all robots.
struct DecisionAlgorithm {
  std::string_view name;
  std::string_view what;  ///< description for --help, one line
  /// Names of the DecisionOptions that the algorithm uses, and "energy" if the candidates may have
  /// costs.
  std::vector<std::string_view> options;
  bool is_optimal = false;  ///< true: the algorithm finds the optimum if there are no attacks
  bool has_bait = false;    ///< bait robots (ResilientRound) keep the plans that they made alone
  /// Returns the number of team choices that are evaluated one by one; null: a polynomial number.
  double (*evaluations)(const TeamOracle& oracle, const DecisionOptions& options) = nullptr;
  TeamDecision (*decide)(const TeamOracle& oracle, const DecisionOptions& options,
                         const Deadline& deadline) = nullptr;

  [[nodiscard]] bool uses(std::string_view option) const;
};

/// Returns the number of sets of at most `attacks_max` of `robots` robots: Σ_{k ≤ attacks_max} C(n,
/// k).
double attack_count(int robots, int attacks_max);

/// Returns all team algorithms. A new one is added in catalogue.cpp.
const std::vector<DecisionAlgorithm>& all_decision_algorithms();

}  // namespace vantage::planner
