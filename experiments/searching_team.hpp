#pragma once

#include <functional>
#include <vector>

#include "core/pose.hpp"
#include "planner/decision/attack.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::experiments {

/// Robots that search for their plans, one beside another, and are where these lead; and an
/// attacker that knows them.
struct SearchingTeam {
  using Search = std::function<planner::SearchResult(const planner::SearchProblem&)>;

  /// Of each robot: one horizon and step, one sensor each, and as its start where it is now. The
  /// targets and what the others' looks bring are plan()'s to say.
  std::vector<planner::SearchProblem> problems;
  std::vector<planner::SearchResult> plans;  ///< of each robot the one it found last

  /// All plan for `targets`, prepared for `attacks_max` attacks: RAIN, or coordinate descent where
  /// there are none.
  void plan(const std::vector<planner::SearchTarget>& targets, int attacks_max,
            const Search& search);
  /// Not 0 of the robots, `attacks` at most, whose sensors the attacker takes; by robot.
  [[nodiscard]] std::vector<char> attacked(planner::Attacker attacker, int attacks) const;
  /// Takes all to where the `step_of_plan`-th step of their plans leads, from 0. Who has no such
  /// step stays and turns by `idle_turn_radps`; how many these are.
  int move(int step_of_plan, double idle_turn_radps);
  [[nodiscard]] std::vector<Pose2> poses() const;
};

}  // namespace vantage::experiments
