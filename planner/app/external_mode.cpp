#include "planner/app/external_mode.hpp"

#include <optional>
#include <utility>

#include "bus/convert/external_channels.hpp"

namespace vantage::planner {

ExternalMode::ExternalMode(NodeState& state) : PlanMode(state) {
  state.subscribe(bus::external_plan_channel(state.robot), state.robot,
                  [this](const models::RobotPlan& answer) { take(answer); });
}

Time ExternalMode::next_tick() const { return is_pending_ ? answer_due_ : PlanMode::next_tick(); }

SlotStage ExternalMode::advance(Time now) {
  const SlotStage stage = PlanMode::advance(now);
  if (stage != SlotStage::kWaiting && std::exchange(is_pending_, false)) {
    state().answers_missing += state().inputs.answer ? 0 : 1;
    return SlotStage::kDue;
  }
  return stage == SlotStage::kDue && request(now) ? SlotStage::kWaiting : stage;
}

bool ExternalMode::request(Time now) {
  NodeState& node = state();
  node.inputs.answer.reset();
  std::optional<models::RobotPlan> request = node.planner.external_request(node.inputs);
  answer_due_ = node.work_end();
  if (!request || now >= answer_due_) {
    return false;
  }
  request->deadline = answer_due_;
  request->finish = now;
  request->inputs = names_of(node.inputs, node.robot);
  is_pending_ = true;  // set first, because the answer may arrive during publish()
  requested_round_ = node.inputs.slot.round;
  node.bus.publish(bus::external_request_channel(node.robot), *std::move(request));
  return true;
}

void ExternalMode::take(const models::RobotPlan& answer) {
  NodeState& node = state();
  const bool is_of_slot = answer.round == requested_round_;
  const bool is_first = !node.inputs.answer || node.inputs.answer->round != answer.round;
  if (is_pending_ && is_of_slot && is_first) {
    ++node.answers;
    node.inputs.answer = answer;
    answer_due_ = node.clock.now();
  } else if (answer.round <= requested_round_ && is_first) {
    ++node.answers_late;
  } else {
    ++node.answers_unasked;
  }
}

}  // namespace vantage::planner
