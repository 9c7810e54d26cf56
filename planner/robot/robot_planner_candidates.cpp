#include "planner/robot/robot_planner.hpp"
#include "planner/robot/trajectory_tools.hpp"

// Plans that are chosen from candidates: by local search, or one after another by their worth.

namespace vantage::planner {

bool RobotPlanner::begin_exchange(const PlanInputs& inputs, const Deadline& deadline) {
  exchange_->end();
  const std::optional<models::Trajectory> committed = committed_motion(inputs);
  if (!committed) {
    return false;
  }
  set_up_problem(inputs, *committed, all_robots());
  begin_candidates(inputs, *committed, deadline);
  return true;
}

void RobotPlanner::begin_candidates(const PlanInputs& inputs, const models::Trajectory& committed,
                                    const Deadline& deadline) {
  TeamExchange::Start start;
  start.round = inputs.slot.round;
  start.rest = stop_from(committed, committed.start_time, spec_->limits.brake_mps2);
  start.is_safe = [this](const models::Trajectory& motion) { return is_safe(motion); };
  if (inputs.attack) {
    start.jammed = inputs.attack->jammed;
  }
  exchange_->begin(problem_, start, deadline);
}

bool RobotPlanner::rest(const models::Trajectory& committed, models::RobotPlan& plan) {
  ++counts_.rests;
  plan.source = models::PlanSource::kSearched;  // it is what the search found
  plan.trajectory = stop_from(committed, committed.start_time, spec_->limits.brake_mps2);
  return is_safe(plan.trajectory);
}

models::RobotPlan RobotPlanner::plan_by_worth(const PlanInputs& inputs,
                                              const models::Trajectory& committed,
                                              const Deadline& deadline) {
  set_up_problem(inputs, committed, {});
  models::RobotPlan plan = blank_plan(inputs);
  begin_candidates(inputs, committed, deadline);
  plan.nodes = exchange_->nodes();
  std::vector<models::TeamChoice> others;
  for (std::size_t i = 0; i < teammates_.size(); ++i) {
    others.push_back({scenario_.robots[teammates_[i]].name, problem_.teammates[i], 0.0, 0.0});
  }
  if (const auto best = exchange_->best_beside(others)) {
    plan.source = models::PlanSource::kSearched;
    plan.trajectory = best->trajectory;
  } else if (!rest(committed, plan)) {
    fall_back(committed, plan);
  }
  return plan;
}

models::RobotPlan RobotPlanner::plan_of_solution(const PlanInputs& inputs,
                                                 const models::Trajectory& committed) {
  set_up_problem(inputs, committed, {});
  models::RobotPlan plan = blank_plan(inputs);
  const bool is_of_this_round = inputs.solution && inputs.solution->round == inputs.slot.round &&
                                inputs.solution->stamp.time == inputs.slot.activation;
  const models::TeamChoice* own = is_of_this_round ? inputs.solution->find(spec_->name) : nullptr;
  if (own != nullptr) {
    const double off_m = (own->trajectory.start.position_m() - committed.start.position_m()).norm();
    if (off_m <= scenario_.planner.tracking_tolerance_m && is_safe(own->trajectory)) {
      plan.source = models::PlanSource::kSearched;
      plan.trajectory = own->trajectory;
      return plan;
    }
    ++counts_.checks_failed;
  } else if (rest(committed, plan)) {
    return plan;
  }
  fall_back(committed, plan);
  return plan;
}

}  // namespace vantage::planner
