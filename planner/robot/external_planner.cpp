#include "planner/robot/external_planner.hpp"

#include "planner/robot/external_answer.hpp"

namespace vantage::planner {

models::RobotPlan ExternalPlanner::plan(SlotTask& task, const Deadline& /*deadline*/) {
  const std::optional<models::RobotPlan>& answer = task.inputs.answer;
  if (answer && answer->round == task.inputs.slot.round) {
    const auto motion = motion_of_answer(*answer, task.committed, planner_, limits_);
    if (!motion) {
      ++task.counts.answers_refused;
    } else if (auto plan = task.ladder.chosen(*motion)) {
      return *plan;
    }
  }
  return task.ladder.fall_back();
}

}  // namespace vantage::planner
