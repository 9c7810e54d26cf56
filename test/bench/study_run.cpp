#include "test/bench/study_run.hpp"

#include <algorithm>
#include <cmath>

#include "core/cpu_time.hpp"
#include "planner/search/arvi.hpp"

namespace vantage::bench {

StudyMethod make_method(const std::string& name, const planner::BeamOptions& beam,
                        const planner::SearchCapacity& capacity) {
  using Found = const planner::SearchResult&;
  if (name == "beam") {
    auto search = std::make_shared<planner::RefiningBeam>(capacity);
    return {name, [search, beam](const auto& problem, const Deadline& deadline) -> Found {
              return search->plan(problem, beam, deadline);
            }};
  }
  if (name == "rvi") {
    auto search = std::make_shared<planner::ReducedValueIteration>(capacity);
    planner::ReducedOptions options;
    options.search = planner::ReducedSearch::kSinglePass;
    options.epsilon = std::numeric_limits<double>::infinity();
    options.delta_m = 0.663;
    options.yaw_weight_m_per_rad = 0.0;
    return {name, [search, options](const auto& problem, const Deadline& deadline) -> Found {
              return search->plan(problem, options, deadline);
            }};
  }
  std::shared_ptr<planner::Search> search = planner::algorithm_called(name).make(capacity, {});
  return {name, [search](const auto& problem, const Deadline& deadline) -> Found {
            return search->plan(problem, deadline);
          }};
}

StudyRun run_within(const tools::PlanningProblem& drawn, const StudyMethod& method, double budget_s,
                    double& nodes_per_s) {
  constexpr int kTriesMax = 5;
  // A longer budget gets two runs; the first measures the rate.
  constexpr double kTwoRunsAbove_s = 1.0;
  constexpr double kMost = 1.02;
  constexpr double kEnough = 0.93;
  StudyRun best;
  best.problem = drawn.name;
  best.targets = static_cast<int>(drawn.problem.targets.size());
  best.method = method.name;
  best.budget_s = budget_s;
  const bool is_long = budget_s >= kTwoRunsAbove_s;
  double nodes = nodes_per_s * budget_s;
  for (int tries = 0; tries < (is_long ? 2 : kTriesMax); ++tries) {
    const double start_s = thread_cpu_s();
    const planner::SearchResult& result =
        method.plan(drawn.problem, Deadline::nodes(std::max<std::int64_t>(1, std::llround(nodes))));
    const double cpu_s = thread_cpu_s() - start_s;
    const bool is_complete = result.found && result.moving_steps == drawn.problem.horizon_steps;
    const bool fits = is_long || cpu_s <= kMost * budget_s;
    if (fits) {
      best.lower_bound = std::max(best.lower_bound, result.lower_bound);
    }
    if (is_complete && fits && result.cost < best.cost) {
      best.cost = result.cost;
      best.cpu_s = cpu_s;
      best.controls = result.controls;
    }
    nodes_per_s = static_cast<double>(result.work_nodes) / cpu_s;
    if (result.stop_reason != planner::StopReason::kDeadline ||
        (cpu_s > kEnough * budget_s && fits)) {
      break;
    }
    nodes *= std::clamp(0.98 * budget_s / cpu_s, 0.2, 20.0);
  }
  return best;
}

}  // namespace vantage::bench
