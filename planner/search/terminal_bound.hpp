#pragma once

#include <cstdint>
#include <vector>

#include "core/pose.hpp"
#include "planner/problem/belief_table.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/heuristic.hpp"

namespace vantage::planner {

/// Lower bound of a problem's terminal value over all plans. A target that no plan can measure
/// within the horizon keeps its stop, and V does not increase with more measurements. So V of those
/// stops alone, with the least travel time to the first of them, is a lower bound of V for every
/// plan. It is added to a bound of J_T. It is 0 if the problem has no terminal value. Allocates
/// nothing after construction.
class TerminalBound {
 public:
  explicit TerminalBound(int targets_max) { measurable_.reserve(index(targets_max)); }

  /// Tabulates `problem`. Call heuristic.reset(problem, beliefs) first. All three arguments must
  /// outlive the queries.
  void reset(const SearchProblem& problem, const BeliefTable& beliefs,
             const InformationHeuristic& heuristic);

  /// Returns a lower bound of V for every plan. It also holds for plans that stop and hover.
  [[nodiscard]] double of_any_plan() const { return least(problem_->start, 0); }

  /// Returns a lower bound of V for every plan through a node at `at` and `depth`. It does not
  /// decrease from a node to its children.
  [[nodiscard]] double least(const Pose2& at, int depth) const {
    return problem_->terminal.is_empty()
               ? 0.0
               : problem_->terminal.least_within(
                     out_of_reach_, at.position_m(),
                     (problem_->horizon_steps - depth) * step_m_ + kRounding_m);
  }

 private:
  static constexpr double kRounding_m = 1e-9;

  const SearchProblem* problem_ = nullptr;
  double step_m_ = 0.0;
  std::vector<std::uint16_t> measurable_;  ///< targets that some plan can measure
  TerminalValue::Rest out_of_reach_;       ///< tour of the other targets
};

}  // namespace vantage::planner
