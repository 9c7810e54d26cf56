#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "planner/decision/attack.hpp"
#include "planner/decision/candidate.hpp"
#include "planner/decision/catalogue.hpp"
#include "planner/decision/decision.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::python {

/// Returns the algorithms of decide(): those of planner/decision/catalogue, and "rain", in which
/// the robots search instead of choosing among candidates (its `decide` is null).
const std::vector<planner::DecisionAlgorithm>& team_algorithms();

/// Options of a team decision. Fields that the algorithm does not use keep their defaults.
struct TeamRequest {
  std::string algorithm = "coordinate_descent";
  planner::InformationMeasure measure = planner::InformationMeasure::kMutual;
  planner::CandidateOptions candidates;  ///< is_anytime is ignored and assumed true
  std::int64_t nodes = 20'000;           ///< budget of work nodes for each robot's search
  planner::DecisionOptions options;
  std::vector<planner::EnergyModel> energy;  ///< one per robot; empty: no motion cost
  /// Search of one robot's plan, for algorithms that search; empty: the default search with
  /// `nodes`.
  std::function<planner::SearchResult(const planner::SearchProblem&)> search;
  bool (*is_cancelled)() = nullptr;  ///< see Deadline::with_cancellation()
};

/// Decision of a team, with the candidates from which it was chosen.
class Decision {
 public:
  /// Computes the decision for the robots in the order of `problems`. The fixed information of the
  /// problems is ignored. @throws UsageError that names the argument that violates a rule
  Decision(std::vector<planner::SearchProblem> problems, const TeamRequest& request);
  ~Decision() = default;
  Decision(const Decision&) = delete;  // the oracle refers to the team
  Decision& operator=(const Decision&) = delete;
  Decision(Decision&&) = delete;
  Decision& operator=(Decision&&) = delete;

  [[nodiscard]] const std::string& algorithm() const { return algorithm_; }
  [[nodiscard]] const planner::TeamProblem& team() const { return team_; }
  /// Returns the index of each robot's chosen candidate; nullopt if it has none.
  [[nodiscard]] std::vector<std::optional<std::size_t>> chosen() const;
  /// Returns the value J of the choice without an attack, nats.
  [[nodiscard]] double value() const { return value_; }
  /// Returns a proven upper bound of J over all choices of these candidates, without an attack,
  /// nats.
  [[nodiscard]] std::optional<double> bound() const { return bound_; }
  [[nodiscard]] const std::vector<int>& bait() const { return bait_; }
  [[nodiscard]] std::int64_t oracle_calls() const { return decided_.oracle_calls; }
  [[nodiscard]] std::int64_t messages() const { return decided_.messages; }
  /// @throws UsageError if there are too many attacks to enumerate
  [[nodiscard]] planner::Attack worst_attack(int attacks_max) const;
  /// Returns a proven upper bound, nats, of J over all paths that the robots' controls allow. With
  /// attacks, the result bounds the value that remains after the worst attack. ∞: no bound is
  /// known.
  /// @throws UsageError that names the argument that breaks a rule
  [[nodiscard]] double paths_bound(int attacks_max, std::int64_t nodes,
                                   bool (*is_cancelled)()) const;

 private:
  std::string algorithm_;
  std::vector<int> bait_;
  planner::TeamDecision decided_;
  planner::TeamProblem team_;
  /// Problems without their worlds, which may no longer exist.
  std::vector<planner::SearchProblem> problems_;
  std::unique_ptr<planner::TeamOracle> oracle_;
  double value_ = 0.0;
  std::optional<double> bound_;
};

}  // namespace vantage::python
