#include "planner/search/root_bound.hpp"

#include <algorithm>
#include <limits>

namespace vantage::planner {

RootBound::RootBound(int targets_max, int horizon_max, int states_max)
    : heuristic_(targets_max, horizon_max), sequencing_(targets_max, horizon_max, states_max) {}

RootBounds RootBound::of(const SearchProblem& problem, const BeliefTable& beliefs,
                         const Deadline& deadline, std::int64_t& work_nodes) {
  heuristic_.reset(problem, beliefs);
  sequencing_.reset(problem, beliefs, heuristic_);
  const auto parts = heuristic_.cost_to_go(problem.start, 0, {}, sequencing_.takes_part().data());
  RootBounds bounds{parts.all, parts.all};
  if (!sequencing_.is_empty() && std::isfinite(parts.all)) {
    const auto answer = sequencing_.cost_to_go(
        problem.start, 0, {}, std::numeric_limits<double>::infinity(), deadline, work_nodes);
    bounds.moving_plan = std::max(bounds.any_plan, parts.all - parts.apart + answer.cost);
  }
  return bounds;
}

}  // namespace vantage::planner
