#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/pose.hpp"
#include "models/belief/gaussian.hpp"
#include "planner/problem/problem.hpp"

// Reference for all searches that shares no code with them. It evaluates every control sequence,
// depth first, and uses only the beliefs, sensors and worlds of models/. The motion of teammates is
// not included (their separation is a conservative test, see motion_table_test).

namespace vantage::test {

/// A state from which a plan can be continued.
struct OracleState {
  Pose2 world_from_body;
  int depth = 0;
  std::vector<models::Gaussian> beliefs;  ///< beliefs at `depth`, per target
  std::vector<std::uint16_t> measured;    ///< targets that the robot has measured, ascending
};

struct OracleAnswer {
  bool found = false;         ///< true if some sequence is feasible and can stop at its end
  double cost = 0.0;          ///< least cost of the steps after `depth` and the terminal value
  std::vector<int> controls;  ///< sequence with the least cost
  /// True if a motion is so near to an obstacle that its clearance depends on rounding.
  bool undecided = false;
};

/// Returns the state at the start of `problem`.
OracleState start_of(const planner::SearchProblem& problem);

/// Returns the cheapest completion from `state` to the horizon. O(|U|^T · M).
OracleAnswer best_completion(const planner::SearchProblem& problem, const OracleState& state);

/// Returns the beliefs after one step: predicted, then updated with the information of the
/// teammates and of the robot.
std::vector<models::Gaussian> look_from(const planner::SearchProblem& problem,
                                        const std::vector<models::Gaussian>& beliefs,
                                        const Pose2& pose, int depth);

/// Returns Σ_m log det or Σ_m tr of the covariances.
double stage_cost(const planner::SearchProblem& problem,
                  const std::vector<models::Gaussian>& beliefs);

/// True if a disc carried along `control` stays clear. The arc is divided until its sagitta is
/// small enough; nullopt within a micrometre of contact.
std::optional<bool> arc_clear(const planner::SearchProblem& problem, const Pose2& from,
                              const models::UnicycleControl& control, double duration_s);

}  // namespace vantage::test
