#pragma once

#include <functional>
#include <vector>

#include "planner/decision/attack.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::experiments {

/// Robots that search for their plans, one beside another, and an attacker that knows these.
struct SearchingTeam {
  using Search = std::function<planner::SearchResult(const planner::SearchProblem&)>;

  /// Of each robot: one set of targets, horizon and step, one sensor each. What the others' looks
  /// bring is plan()'s to say.
  std::vector<planner::SearchProblem> problems;
  std::vector<planner::SearchResult> plans;  ///< of each robot the one it found last

  /// All plan, prepared for `attacks_max` attacks: RAIN, or coordinate descent where there are
  /// none.
  void plan(int attacks_max, const Search& search);
  /// Not 0 of the robots, `attacks` at most, whose sensors the attacker takes; by robot.
  [[nodiscard]] std::vector<char> attacked(planner::Attacker attacker, int attacks) const;
};

}  // namespace vantage::experiments
