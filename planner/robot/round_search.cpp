#include "planner/robot/round_search.hpp"

#include <algorithm>
#include <utility>

#include "planner/mapping/map_planner.hpp"
#include "planner/problem/belief_table.hpp"
#include "planner/search/catalogue.hpp"

namespace vantage::planner {
namespace {

// Returns Σ_{t=1}^{T} of the stage costs without measurements of this search.
double cost_without_looks(const SearchProblem& problem) {
  BeliefTable beliefs(static_cast<int>(problem.targets.size()), problem.horizon_steps);
  beliefs.reset(problem);
  double cost = 0.0;
  for (int t = 1; t <= problem.horizon_steps; ++t) {
    cost += beliefs.open_loop_cost(t);
  }
  return cost;
}

class TargetSearch : public RoundSearch {
 public:
  TargetSearch(Workspace& workspace, std::size_t robot) {
    if (algorithm_called(workspace.scenario().planner.algorithm).is_stateful) {
      own_search_ = workspace.make_search(static_cast<int>(robot));
    }
    search_ = own_search_ ? own_search_.get() : &workspace.search();
  }

  Found plan(const RoundProblem& round, const Deadline& deadline) override {
    const SearchResult& result = search_->plan(round.search, deadline);
    // No motion is possible: the search ended without generating a child.
    return {result, result.nodes_generated == 0 && result.stop_reason != StopReason::kDeadline};
  }

  [[nodiscard]] double gain_nats(const RoundProblem& round, const Found& found) const override {
    const double cost = found.result.cost - terminal_cost(round.search, found.result.poses);
    return std::max(0.0, cost_without_looks(round.search) - cost);
  }

 private:
  std::unique_ptr<Search> own_search_;  ///< only if the algorithm keeps state between plans
  Search* search_ = nullptr;            ///< the search of the workspace, or own_search_
};

class MapSearch : public RoundSearch {
 public:
  explicit MapSearch(const scenario::Scenario& scenario) : planner_(scenario) {}

  Found plan(const RoundProblem& round, const Deadline& deadline) override {
    plan_ = planner_.plan(round.search, round.looks, round.teammates, deadline);
    return {plan_.result};
  }

  [[nodiscard]] double gain_nats(const RoundProblem& /*round*/,
                                 const Found& /*found*/) const override {
    return plan_.gain_nats;
  }

 private:
  MapPlanner planner_;
  MapPlan plan_;
};

}  // namespace

std::unique_ptr<RoundSearch> make_round_search(Workspace& workspace, std::size_t robot) {
  const scenario::Scenario& scenario = workspace.scenario();
  if (scenario.planner.objective == scenario::PlanObjective::kMapping) {
    return std::make_unique<MapSearch>(scenario);
  }
  return std::make_unique<TargetSearch>(workspace, robot);
}

}  // namespace vantage::planner
