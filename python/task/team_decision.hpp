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
#include "planner/decision/decision.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::python {

/// One of the ways of planner/decision in which a team may decide.
struct TeamAlgorithm {
  std::string_view name;
  std::string_view what;                  ///< one line
  std::vector<std::string_view> options;  ///< what else of a request means something to it
};
const std::vector<TeamAlgorithm>& team_algorithms();

/// How a team is to decide. Options that mean nothing to the algorithm are as they are here.
struct TeamRequest {
  std::string algorithm = "coordinate_descent";
  planner::InformationMeasure measure = planner::InformationMeasure::kMutual;
  planner::CandidateOptions candidates;  ///< anytime, whatever it says
  std::int64_t nodes = 20'000;           ///< of work, of each robot's search
  int attacks_max = 0;
  std::vector<int> order;  ///< of coordinate descent; empty: 0, 1, 2, …
  int rounds_max = 1;
  double alpha = 1.0;                        ///< of local searches
  std::vector<planner::EnergyModel> energy;  ///< empty: motion costs nothing; else one a robot
  /// Finds a robot's plan, where robots search; empty: the default search, with `nodes`.
  std::function<planner::SearchResult(const planner::SearchProblem&)> search;
  bool (*is_cancelled)() = nullptr;  ///< see Deadline::unless
};

/// What a team decided, and what it could choose from.
class Decision {
 public:
  /// Robots in the order of `problems`, whose fixed information is not used.
  /// @throws UsageError naming the argument that breaks a rule
  Decision(std::vector<planner::SearchProblem> problems, const TeamRequest& request);
  ~Decision() = default;
  Decision(const Decision&) = delete;  // the oracle refers to the team
  Decision& operator=(const Decision&) = delete;
  Decision(Decision&&) = delete;
  Decision& operator=(Decision&&) = delete;

  [[nodiscard]] const std::string& algorithm() const { return algorithm_; }
  [[nodiscard]] const planner::TeamProblem& team() const { return team_; }
  /// Of each robot which of its candidates it was given; nullopt: none.
  [[nodiscard]] std::vector<std::optional<std::size_t>> chosen() const;
  /// J of what was chosen, nobody attacked, nats.
  [[nodiscard]] double value() const { return value_; }
  /// Proven: no choice of these candidates is worth more, nobody attacked.
  [[nodiscard]] std::optional<double> bound() const { return bound_; }
  [[nodiscard]] const std::vector<int>& bait() const { return bait_; }
  [[nodiscard]] std::int64_t oracle_calls() const { return decided_.oracle_calls; }
  [[nodiscard]] std::int64_t messages() const { return decided_.messages; }
  /// @throws UsageError when there are too many attacks to look at one by one
  [[nodiscard]] planner::Attack worst_attack(int attacks_max) const;
  /// Proven: no paths that the robots' controls allow are worth more, however they were found, or,
  /// with attacks, leave more to the team under the worst one, nats; ∞: nothing is known.
  /// @throws UsageError naming the argument that breaks a rule
  [[nodiscard]] double paths_bound(int attacks_max, std::int64_t nodes,
                                   bool (*is_cancelled)()) const;

 private:
  std::string algorithm_;
  std::vector<int> bait_;
  planner::TeamDecision decided_;
  planner::TeamProblem team_;
  std::vector<planner::SearchProblem> problems_;  ///< without worlds, which may be gone
  std::unique_ptr<planner::TeamOracle> oracle_;
  double value_ = 0.0;
  std::optional<double> bound_;
};

}  // namespace vantage::python
