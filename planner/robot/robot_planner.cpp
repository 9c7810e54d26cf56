#include "planner/robot/robot_planner.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/check.hpp"
#include "planner/robot/commitment.hpp"

namespace vantage::planner {

RobotPlanner::RobotPlanner(const scenario::Scenario& scenario, const std::string& robot)
    : RobotPlanner(std::make_shared<Workspace>(scenario), robot) {}

RobotPlanner::RobotPlanner(std::shared_ptr<Workspace> workspace, const std::string& robot)
    : workspace_(std::move(workspace)), scenario_(workspace_->scenario()) {
  const std::optional<std::size_t> index = workspace_->index_of(robot);
  require(index.has_value(), "planner: no robot '" + robot + "' in the scenario");
  robot_ = *index;
  const int slots = scenario_.planner.slots;
  if (slots > 0 && robot_count() > slots) {
    slots_.emplace(*workspace_, robot_index());
  }
  slot_planner_ = make_slot_planner(*workspace_, robot_);
}

models::RobotPlan RobotPlanner::blank_plan_of(const PlanInputs& inputs) const {
  return blank_plan(scenario_.planner, scenario_.robots[robot_].name, inputs.slot);
}

std::optional<models::Trajectory> RobotPlanner::committed_motion(const PlanInputs& inputs) {
  Commitment commitment = commitment_of(scenario_, robot_, inputs);
  counts_.off_plan += commitment.is_off_plan ? 1 : 0;
  const int rounds = inputs.slot.is_proposal ? 0 : 1;
  switch (commitment.known) {
    case Commitment::Known::kMotion:
      return std::move(commitment.motion);
    case Commitment::Known::kNoPose:
      counts_.no_pose += rounds;
      break;
    case Commitment::Known::kUnknownPlan:
      counts_.unknown_plan += rounds;
      break;
  }
  return std::nullopt;
}

SlotTask RobotPlanner::task_of(const PlanInputs& inputs, const models::Trajectory& committed,
                               const std::vector<int>& robots_without_sensing) {
  round_ = problem_of_round(*workspace_, robot_, inputs, committed, robots_without_sensing);
  counts_.unusable_beliefs += round_.unusable_beliefs;
  counts_.unusable_maps += round_.unusable_maps;
  counts_.bodies_dropped += round_.bodies_dropped;
  return {inputs, committed, round_,
          PlanLadder(round_.search, committed, blank_plan_of(inputs), counts_), counts_};
}

ResilientRound RobotPlanner::resilient_round_of(const PlanInputs& inputs) const {
  std::vector<double> values(scenario_.robots.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto proposal = inputs.proposals.find(scenario_.robots[i].name);
    if (proposal != inputs.proposals.end() && proposal->second.plan.round == inputs.slot.round) {
      values[i] = proposal->second.value_nats;
    }
  }
  // Robots without a proposal, or with a proposal that gains nothing, are not used as bait.
  const auto useful_proposals =
      std::count_if(values.begin(), values.end(), [](double v) { return v > 0; });
  return {values, std::min(scenario_.planner.attacks_max, static_cast<int>(useful_proposals))};
}

std::vector<int> RobotPlanner::all_robots() const {
  std::vector<int> all(scenario_.robots.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::optional<models::RobotPlan> RobotPlanner::plan(const PlanInputs& inputs,
                                                    const Deadline& deadline) {
  const std::optional<models::Trajectory> committed = committed_motion(inputs);
  if (!committed) {
    return std::nullopt;
  }
  const ResilientRound resilient = resilient_round_of(inputs);
  SlotTask task = task_of(inputs, *committed, resilient.robots_without_sensing_for(robot_index()));
  if (slots_ && !slots_->has_slot(inputs)) {
    ++counts_.yielded_rounds;
    return task.ladder.fall_back();
  }
  task.is_bait = resilient.is_bait(robot_index());
  return slot_planner_->plan(task, deadline);
}

std::optional<models::PlanProposal> RobotPlanner::propose(const PlanInputs& inputs,
                                                          const Deadline& deadline) {
  const std::optional<models::Trajectory> committed = committed_motion(inputs);
  if (!committed) {
    return std::nullopt;
  }
  SlotTask task = task_of(inputs, *committed, all_robots());
  return slot_planner_->propose(task, deadline);
}

std::unique_ptr<TeamExchange> RobotPlanner::begin_exchange(const PlanInputs& inputs,
                                                           const Deadline& deadline) {
  const std::optional<models::Trajectory> committed = committed_motion(inputs);
  return committed
             ? slot_planner_->begin_exchange(task_of(inputs, *committed, all_robots()), deadline)
             : nullptr;
}

std::optional<models::RobotPlan> RobotPlanner::external_request(const PlanInputs& inputs) const {
  Commitment commitment = commitment_of(scenario_, robot_, inputs);
  if (commitment.known != Commitment::Known::kMotion) {
    return std::nullopt;
  }
  models::RobotPlan request = blank_plan_of(inputs);
  request.source = models::PlanSource::kShifted;
  request.trajectory = std::move(commitment.motion);
  return request;
}

std::optional<models::RobotPlan> RobotPlanner::plan_without_search(const PlanInputs& inputs) {
  const std::optional<models::Trajectory> committed = committed_motion(inputs);
  if (!committed) {
    return std::nullopt;
  }
  return task_without_search(inputs, *committed).ladder.fall_back();
}

std::optional<models::RobotPlan> RobotPlanner::plan_to_stop(const PlanInputs& inputs) {
  const std::optional<models::Trajectory> committed = committed_motion(inputs);
  if (!committed) {
    return std::nullopt;
  }
  return task_without_search(inputs, *committed).ladder.stopped();
}

SlotTask RobotPlanner::task_without_search(const PlanInputs& inputs,
                                           const models::Trajectory& committed) {
  return task_of(inputs, committed,
                 resilient_round_of(inputs).robots_without_sensing_for(robot_index()));
}

std::optional<int> RobotPlanner::next_slot_index(const PlanInputs& inputs) const {
  return slots_ ? std::optional(slots_->next_slot_index(inputs)) : std::nullopt;
}

}  // namespace vantage::planner
