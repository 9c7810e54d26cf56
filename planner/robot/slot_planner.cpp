#include "planner/robot/slot_planner.hpp"

#include "planner/robot/candidate_planners.hpp"
#include "planner/robot/external_planner.hpp"
#include "planner/robot/searching_planner.hpp"
#include "planner/search/catalogue.hpp"
#include "scenario/search_name.hpp"

namespace vantage::planner {

std::optional<models::PlanProposal> SlotPlanner::propose(SlotTask& /*task*/,
                                                         const Deadline& /*deadline*/) {
  return std::nullopt;
}

std::unique_ptr<TeamExchange> SlotPlanner::begin_exchange(const SlotTask& /*task*/,
                                                          const Deadline& /*deadline*/) {
  return nullptr;
}

std::unique_ptr<SlotPlanner> make_slot_planner(Workspace& workspace, std::size_t robot) {
  const scenario::Scenario& scenario = workspace.scenario();
  const scenario::PlannerSpec& planner = scenario.planner;
  if (scenario::is_external(planner)) {
    return std::make_unique<ExternalPlanner>(scenario, robot);
  }
  if (planner.objective != scenario::PlanObjective::kMapping) {
    if (planner.team_algorithm.exchanges_solutions()) {
      return std::make_unique<TeamSolutionPlanner>(workspace, robot);
    }
    if (algorithm_called(planner.algorithm).makes_candidates && planner.attacks_max == 0 &&
        scenario.robots[robot].energy.price_nats > 0.0) {
      return std::make_unique<CoordinateDescentPlanner>(workspace, robot);
    }
  }
  return std::make_unique<SearchingPlanner>(workspace, robot);
}

}  // namespace vantage::planner
