#pragma once

#include <optional>
#include <vector>

#include "core/pose.hpp"
#include "models/belief/gaussian.hpp"
#include "planner/problem/problem.hpp"

// What a search has to agree with, written without anything of the search: every control sequence,
// depth first, with the beliefs, sensors and worlds of models/ alone. Teammates' motion is left
// out (their separation is a conservative test, see motion_table_test).

namespace vantage::test {

/// Where a plan may be continued from.
struct OracleState {
  Pose2 world_from_body;
  int depth = 0;
  std::vector<models::Gaussian> beliefs;  ///< of each target, at `depth`
};

struct OracleAnswer {
  bool found = false;         ///< some sequence is feasible and can stop at its end
  double cost = 0.0;          ///< least cost of the steps after `depth`
  std::vector<int> controls;  ///< that cost it
  /// Some motion came so near to an obstacle that its clearance could not be decided.
  bool undecided = false;
};

/// The state at the start of `problem`.
OracleState start_of(const planner::SearchProblem& problem);

/// The cheapest completion from `state` to the horizon. O(|U|^T · M).
OracleAnswer best_completion(const planner::SearchProblem& problem, const OracleState& state);

/// The beliefs after one step: predicted, then updated by the teammates' and the own information.
std::vector<models::Gaussian> look_from(const planner::SearchProblem& problem,
                                        const std::vector<models::Gaussian>& beliefs,
                                        const Pose2& pose, int depth);

/// Σ_m log det or tr.
double stage_cost(const planner::SearchProblem& problem,
                  const std::vector<models::Gaussian>& beliefs);

/// Whether a disc carried along `control` stays clear: by chords cut until the sagitta decides;
/// nullopt when it is within a micrometre of touching.
std::optional<bool> arc_clear(const planner::SearchProblem& problem, const Pose2& from,
                              const models::UnicycleControl& control, double duration_s);

}  // namespace vantage::test
