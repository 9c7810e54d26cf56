#include "planner/search/terminal_bound.hpp"

namespace vantage::planner {

void TerminalBound::reset(const SearchProblem& problem, const BeliefTable& beliefs,
                          const InformationHeuristic& heuristic) {
  problem_ = &problem;
  step_m_ = heuristic.step_m();
  measurable_.clear();
  if (problem.terminal.is_empty()) {
    return;
  }
  const auto is_measurable = [&](int m) {
    for (int k = 1; k <= problem.horizon_steps; ++k) {
      const double away_m = (beliefs.mean_m(m, k).head<2>() - problem.start.position_m()).norm();
      if (away_m <= heuristic.sight_m(m) + k * step_m_ + kRounding_m) {
        return true;
      }
    }
    return false;
  };
  for (int m = 0; m < beliefs.target_count(); ++m) {
    if (is_measurable(m)) {
      measurable_.push_back(static_cast<std::uint16_t>(m));
    }
  }
  out_of_reach_ = problem.terminal.rest(measurable_);
}

}  // namespace vantage::planner
