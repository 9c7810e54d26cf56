#include "planner/robot/candidate_planners.hpp"

#include <optional>
#include <utility>
#include <vector>

#include "planner/robot/trajectory_tools.hpp"
#include "planner/robot/turn_to_free_heading.hpp"

namespace vantage::planner {

std::unique_ptr<TeamExchange> CandidatePlanner::round_of(
    const SlotTask& task, std::optional<std::vector<models::TeamChoice>> committed,
    const Deadline& deadline) {
  TeamExchange::Start start;
  start.round = task.inputs.slot.round;
  start.rest = stop_from(task.committed, task.committed.start_time, task.round.search.brake_mps2);
  start.committed = std::move(committed);
  if (task.inputs.attack) {
    start.jammed = task.inputs.attack->jammed;
  }
  return std::make_unique<TeamExchange>(scenario_, static_cast<int>(robot_), search_,
                                        task.round.search, start, deadline);
}

std::optional<models::RobotPlan> CandidatePlanner::turned(SlotTask& task,
                                                          const models::TeamChoice* own) const {
  const bool stays =
      is_stationary(task.committed) && (own == nullptr || is_stationary(own->trajectory));
  if (!stays || can_move_after_turn(task.round.search, 0.0)) {
    return std::nullopt;
  }
  auto turning = turn_to_free_heading(task.round.search, false,
                                      scenario_.robots[robot_].limits.yaw_rate_max_radps);
  return turning ? std::optional(task.ladder.turned(std::move(*turning))) : std::nullopt;
}

models::RobotPlan CoordinateDescentPlanner::plan(SlotTask& task, const Deadline& deadline) {
  std::vector<models::TeamChoice> others;
  for (const FixedTeammate& teammate : task.round.teammates) {
    others.push_back({scenario().robots[teammate.robot].name, teammate.trajectory, 0.0, 0.0});
  }
  // The steps after the search do not read the clock, so the same node budget gives the same plan.
  const std::unique_ptr<TeamExchange> round = round_of(task, std::move(others), deadline.third());
  task.ladder.set_nodes(round->nodes());
  const auto best = round->improve(Deadline::never());
  const models::TeamChoice* own = best ? best->find(scenario().robots[robot()].name) : nullptr;
  if (auto plan = turned(task, own)) {
    return *plan;
  }
  if (auto plan = own != nullptr ? task.ladder.chosen(own->trajectory) : task.ladder.hovering()) {
    return *plan;
  }
  return task.ladder.fall_back();
}

models::RobotPlan TeamSolutionPlanner::plan(SlotTask& task, const Deadline& /*deadline*/) {
  const std::optional<models::TeamProposal>& solution = task.inputs.solution;
  const bool is_of_this_round = solution && solution->round == task.inputs.slot.round &&
                                solution->stamp.time == task.inputs.slot.activation;
  const models::TeamChoice* own =
      is_of_this_round ? solution->find(scenario().robots[robot()].name) : nullptr;
  if (auto plan = turned(task, own)) {
    return *plan;
  }
  if (own == nullptr) {
    const auto plan = task.ladder.hovering();
    return plan ? *plan : task.ladder.fall_back();
  }
  const double off_m =
      (own->trajectory.start.position_m() - task.committed.start.position_m()).norm();
  if (!(off_m <= scenario().planner.tracking_tolerance_m)) {
    ++task.counts.checks_failed;
  } else if (auto plan = task.ladder.chosen(own->trajectory)) {
    return *plan;
  }
  return task.ladder.fall_back();
}

std::unique_ptr<TeamExchange> TeamSolutionPlanner::begin_exchange(const SlotTask& task,
                                                                  const Deadline& deadline) {
  return round_of(task, std::nullopt, deadline);
}

}  // namespace vantage::planner
