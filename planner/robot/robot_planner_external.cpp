#include "planner/robot/external_answer.hpp"
#include "planner/robot/robot_planner.hpp"

// Plans that another process is asked for.

namespace vantage::planner {

std::optional<models::RobotPlan> RobotPlanner::question(const PlanInputs& inputs) {
  const PlannerCounts counts = counts_;  // the plan of the same slot counts
  const std::optional<models::Trajectory> committed = committed_motion(inputs);
  counts_ = counts;
  if (!committed) {
    return std::nullopt;
  }
  models::RobotPlan question = blank_plan(inputs);
  question.source = models::PlanSource::kShifted;
  question.trajectory = *committed;
  return question;
}

models::RobotPlan RobotPlanner::plan_of_answer(const PlanInputs& inputs,
                                               const models::Trajectory& committed) {
  set_up_problem(inputs, committed, {});
  models::RobotPlan plan = blank_plan(inputs);
  if (inputs.answer && inputs.answer->round == inputs.slot.round) {
    auto motion = motion_of_answer(*inputs.answer, committed, scenario_.planner, spec_->limits);
    if (!motion) {
      ++counts_.answers_refused;
    } else if (!is_safe(*motion)) {
      ++counts_.checks_failed;
    } else {
      plan.source = models::PlanSource::kSearched;
      plan.trajectory = std::move(*motion);
      return plan;
    }
  }
  fall_back(committed, plan);
  return plan;
}

}  // namespace vantage::planner
