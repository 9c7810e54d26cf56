#include "planner/robot/searching_planner.hpp"

#include <utility>

#include "planner/robot/trajectory_tools.hpp"
#include "planner/robot/turn_to_free_heading.hpp"

namespace vantage::planner {

models::RobotPlan SearchingPlanner::plan(SlotTask& task, const Deadline& deadline) {
  if (task.is_bait) {
    ++task.counts.bait_rounds;
    if (auto plan = task.ladder.proposed(task.inputs.proposals.at(spec_.name).plan)) {
      return *plan;
    }
  }
  const RoundSearch::Found found = search_->plan(task.round, deadline);
  const SearchResult& result = found.result;
  task.ladder.set_nodes(result.replay_budget_nodes());
  if (is_stationary(task.committed) && !(result.found && result.moving_steps > 0)) {
    if (auto turning = turn_to_free_heading(task.round.search, found.is_blocked,
                                            spec_.limits.yaw_rate_max_radps)) {
      return task.ladder.turned(std::move(*turning));
    }
  }
  const auto plan = task.ladder.searched(result);
  return plan ? *plan : task.ladder.fall_back();
}

std::optional<models::PlanProposal> SearchingPlanner::propose(SlotTask& task,
                                                              const Deadline& deadline) {
  const RoundSearch::Found found = search_->plan(task.round, deadline);
  task.ladder.set_nodes(found.result.replay_budget_nodes());
  models::PlanProposal proposal;
  proposal.stamp.time = task.inputs.slot.activation;
  if (auto plan = task.ladder.searched(found.result)) {
    proposal.plan = std::move(*plan);
    proposal.value_nats = search_->gain_nats(task.round, found);
  } else {
    proposal.plan = task.ladder.fall_back();
  }
  return proposal;
}

}  // namespace vantage::planner
