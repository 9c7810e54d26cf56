#include "planner/team/round.hpp"

#include "core/check.hpp"

namespace vantage::planner {

RoundSchedule::RoundSchedule(const models::PlannerSpec& spec, int robot_index, int robot_count)
    : round_(from_seconds(spec.step_s * spec.execute_steps)),
      margin_(from_seconds(spec.publish_margin_s)),
      budget_(from_seconds(spec.team_budget_s)),
      robot_index_(robot_index),
      robot_count_(robot_count) {
  require(robot_count >= 1 && robot_index >= 0 && robot_index < robot_count,
          "planning round: robot_index must be in [0, robot_count)");
  require(round_.count() > 0, "planning round: execute_steps · step_s must be > 0");
  require(budget_ + margin_ <= round_,
          "planning round: team_budget_s + publish_margin_s must fit into a round");
}

RoundSchedule::Slot RoundSchedule::slot(std::int64_t round) const {
  Slot slot;
  slot.round = round;
  slot.activation = Time{(round + 1) * round_};
  const Time begin = slot.activation - margin_ - budget_;
  slot.begin = begin + budget_ * robot_index_ / robot_count_;
  slot.end = begin + budget_ * (robot_index_ + 1) / robot_count_;
  return slot;
}

RoundSchedule::Slot RoundSchedule::next_slot(Time now) const {
  std::int64_t round = now.time_since_epoch() / round_;
  while (slot(round).begin <= now) {
    ++round;
  }
  return slot(round);
}

}  // namespace vantage::planner
