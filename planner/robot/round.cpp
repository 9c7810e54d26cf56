#include "planner/robot/round.hpp"

#include "core/check.hpp"

namespace vantage::planner {

RoundSchedule::RoundSchedule(const scenario::PlannerSpec& spec, int robot_index, int robot_count)
    : round_(from_seconds(spec.step_s * spec.execute_steps)),
      margin_(from_seconds(spec.publish_margin_s)),
      budget_(from_seconds(spec.team_budget_s)),
      robot_index_(robot_index),
      robot_count_(robot_count),
      is_exchange_(spec.team_algorithm == scenario::TeamAlgorithm::kLocalSearch),
      has_proposals_(is_exchange_ || spec.attacks_max > 0) {
  require(robot_count >= 1 && robot_index >= 0 && robot_index < robot_count,
          "planning round: robot_index must be in [0, robot_count)");
  require(round_.count() > 0, "planning round: execute_steps · step_s must be > 0");
  require(budget_ + margin_ <= round_,
          "planning round: team_budget_s + publish_margin_s must fit into a round");
}

RoundSchedule::Slot RoundSchedule::part_of(std::int64_t round, Duration from,
                                           Duration length) const {
  Slot slot;
  slot.round = round;
  slot.activation = Time{(round + 1) * round_};
  const Time begin = slot.activation - margin_ - budget_ + from;
  slot.begin = begin + length * robot_index_ / robot_count_;
  slot.end = begin + length * (robot_index_ + 1) / robot_count_;
  return slot;
}

RoundSchedule::Slot RoundSchedule::slot(std::int64_t round) const {
  const Duration for_proposals = has_proposals_ ? budget_ / 2 : Duration{0};
  return part_of(round, for_proposals, budget_ - for_proposals);
}

RoundSchedule::Slot RoundSchedule::proposal_slot(std::int64_t round) const {
  Slot slot = part_of(round, Duration{0}, budget_ / 2);
  if (is_exchange_) {
    slot.begin = slot.activation - margin_ - budget_;
    slot.end = slot.begin + budget_ / 2;
  }
  slot.is_proposal = true;
  return slot;
}

RoundSchedule::Slot RoundSchedule::next_slot(Time now) const {
  for (std::int64_t round = now.time_since_epoch() / round_;; ++round) {
    if (has_proposals_ && proposal_slot(round).begin > now) {
      return proposal_slot(round);
    }
    if (slot(round).begin > now) {
      return slot(round);
    }
  }
}

}  // namespace vantage::planner
