#pragma once

#include <functional>
#include <vector>

#include "core/pose.hpp"
#include "planner/decision/attack.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::experiments {

/// A team that plans by search, one robot after another, and follows its plans exactly, and an
/// attacker that knows the plans.
struct SearchingTeam {
  using Search = std::function<planner::SearchResult(const planner::SearchProblem&)>;

  /// One problem per robot, with the same horizon and step and one sensor each. `start` is the
  /// robot's current pose. plan() sets the targets and the information of the other robots.
  std::vector<planner::SearchProblem> problems;
  std::vector<planner::SearchResult> plans;  ///< by robot: its latest plan

  /// Plans with all robots for `targets`: by RAIN for `attacks_max` attacks, or by coordinate
  /// descent if attacks_max is 0.
  void plan(const std::vector<planner::SearchTarget>& targets, int attacks_max,
            const Search& search);
  /// Returns one entry per robot: nonzero if its sensor is attacked. At most `attacks` entries are
  /// nonzero.
  [[nodiscard]] std::vector<char> attacked(planner::Attacker attacker, int attacks) const;
  /// Moves all robots by step `step_of_plan` (from 0) of their plans. A robot without such a step
  /// stays and turns by `idle_turn_radps`. Returns the number of robots without such a step.
  int move(int step_of_plan, double idle_turn_radps);
  [[nodiscard]] std::vector<Pose2> poses() const;
};

}  // namespace vantage::experiments
