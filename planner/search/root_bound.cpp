#include "planner/search/root_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vantage::planner {

RootBound::RootBound(int targets_max, int horizon_max, int states_max)
    : heuristic_(targets_max, horizon_max),
      sequencing_(targets_max, horizon_max, states_max),
      near_(targets_max, horizon_max),
      prefix_(targets_max, horizon_max),
      terminal_(targets_max) {}

double RootBound::of_any_plan(const SearchProblem& problem, const BeliefTable& beliefs) {
  heuristic_.reset(problem, beliefs);
  sequencing_.reset(problem, beliefs, heuristic_);
  terminal_.reset(problem, beliefs, heuristic_);
  problem_ = &problem;
  is_raised_ = false;
  start_ = problem.start;
  const auto parts = heuristic_.cost_to_go(start_, 0, {}, sequencing_.takes_part().data());
  others_ = parts.all - parts.apart;
  near_.reset(problem, beliefs, heuristic_);
  outside_near_ =
      near_.is_empty()
          ? parts.all
          : parts.all - heuristic_.cost_to_go(start_, 0, {}, near_.takes_part().data()).apart;
  double floors = 0.0;
  for (int k = 1; k <= problem.horizon_steps; ++k) {
    floors += heuristic_.stage_floor(k);
  }
  reach_ = parts.all;
  any_plan_ = std::max(parts.all, floors);
  return any_plan_ + terminal_.of_any_plan();
}

RootBound::Answer RootBound::of_moving_plan(const Deadline& deadline, std::int64_t& work_nodes) {
  Answer best{any_plan_, false};
  if (!std::isfinite(any_plan_)) {
    return {any_plan_ + terminal_.of_any_plan(), false};
  }
  double sequenced = 0.0;  // increase of the bound over h at the root
  if (!sequencing_.is_empty()) {
    const auto answer = sequencing_.cost_to_go(
        start_, 0, {}, std::numeric_limits<double>::infinity(), deadline, work_nodes);
    best = {std::max(best.cost, others_ + answer.cost), answer.expired};
    bool disjoint = true;
    for (std::size_t m = 0; m < near_.takes_part().size(); ++m) {
      disjoint = disjoint && (near_.takes_part()[m] == 0 || sequencing_.takes_part()[m] == 0);
    }
    sequenced = disjoint ? std::max(0.0, others_ + answer.cost - reach_) : 0.0;
  }
  if (!near_.is_empty() && !best.expired) {
    const auto answer = near_.cost(deadline, work_nodes);
    best = {std::max(best.cost, outside_near_ + sequenced + answer.cost), answer.expired};
  }
  return {best.cost + terminal_.of_any_plan(), best.expired};
}

RootBound::Answer RootBound::raise(Expander& expander, std::int64_t until_nodes,
                                   const Deadline& deadline, std::int64_t& work_nodes) {
  if (!is_raised_) {
    prefix_.reset(*problem_, expander);
    is_raised_ = true;
  }
  // the tree of prefix_ bounds J_T without the terminal value
  expander.include_terminal_value(false);
  const auto answer = prefix_.raise(until_nodes, deadline, work_nodes);
  expander.include_terminal_value(true);
  return {answer.cost + terminal_.of_any_plan(), answer.expired};
}

}  // namespace vantage::planner
