#include "planner/search/root_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vantage::planner {

RootBound::RootBound(int targets_max, int horizon_max, int states_max)
    : heuristic_(targets_max, horizon_max), sequencing_(targets_max, horizon_max, states_max) {}

double RootBound::of_any_plan(const SearchProblem& problem, const BeliefTable& beliefs) {
  heuristic_.reset(problem, beliefs);
  sequencing_.reset(problem, beliefs, heuristic_);
  start_ = problem.start;
  const auto parts = heuristic_.cost_to_go(start_, 0, {}, sequencing_.takes_part().data());
  others_ = parts.all - parts.apart;
  double floors = 0.0;
  for (int k = 1; k <= problem.horizon_steps; ++k) {
    floors += heuristic_.stage_floor(k);
  }
  any_plan_ = std::max(parts.all, floors);
  return any_plan_;
}

SequencingBound::Answer RootBound::of_moving_plan(const Deadline& deadline,
                                                  std::int64_t& work_nodes) {
  if (sequencing_.is_empty() || !std::isfinite(any_plan_)) {
    return {any_plan_, false};
  }
  const auto answer = sequencing_.cost_to_go(start_, 0, {}, std::numeric_limits<double>::infinity(),
                                             deadline, work_nodes);
  return {std::max(any_plan_, others_ + answer.cost), answer.expired};
}

}  // namespace vantage::planner
