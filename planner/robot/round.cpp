#include "planner/robot/round.hpp"

#include <algorithm>

#include "core/check.hpp"

namespace vantage::planner {

RoundSchedule::RoundSchedule(const scenario::PlannerSpec& spec, int robot_index, int robot_count)
    : round_(from_seconds(spec.step_s * spec.execute_steps)),
      margin_(from_seconds(spec.publish_margin_s)),
      budget_(from_seconds(spec.team_budget_s)),
      is_shared_(spec.slots > 0 && robot_count > spec.slots),
      slots_(is_shared_ ? spec.slots : robot_count),
      is_exchange_(spec.team_algorithm.exchanges_solutions()),
      has_proposals_(is_exchange_ || spec.attacks_max > 0) {
  require(robot_count >= 1 && robot_index >= 0 && robot_index < robot_count,
          "planning round: robot_index must be in [0, robot_count)");
  require(round_.count() > 0, "planning round: execute_steps · step_s must be > 0");
  require(budget_ + margin_ <= round_,
          "planning round: team_budget_s + publish_margin_s must fit into a round");
  slot_index_ = robot_index % slots_;
}

RoundSchedule::Slot RoundSchedule::part_of(std::int64_t round, int slot_index, Duration from,
                                           Duration length) const {
  Slot slot;
  slot.slot_index = slot_index;
  slot.round = round;
  slot.activation = Time{(round + 1) * round_};
  const Time begin = slot.activation - margin_ - budget_ + from;
  slot.begin = begin + length * slot_index / slots_;
  slot.end = begin + length * (slot_index + 1) / slots_;
  return slot;
}

RoundSchedule::Slot RoundSchedule::slot(std::int64_t round) const {
  return slot(round, slot_index_);
}

RoundSchedule::Slot RoundSchedule::slot(std::int64_t round, int slot_index) const {
  const Duration for_proposals = has_proposals_ ? budget_ / 2 : Duration{0};
  return part_of(round, slot_index, for_proposals, budget_ - for_proposals);
}

RoundSchedule::Slot RoundSchedule::slot_after(std::int64_t round, Time now, int slot_index) const {
  std::int64_t next = std::max(round + 1, now.time_since_epoch() / round_);
  while (slot(next, slot_index).begin <= now) {
    ++next;
  }
  return slot(next, slot_index);
}

std::optional<int> RoundSchedule::slot_index_of(const models::RobotPlan& plan) const {
  const Duration into = plan.slot_start - slot(plan.round, 0).begin;
  const Duration length = slot(plan.round, slots_ - 1).end - slot(plan.round, 0).begin;
  if (into < Duration{0} || into >= length) {
    return std::nullopt;
  }
  const auto near = static_cast<int>((into.count() * slots_ + length.count() / 2) / length.count());
  for (const int slot_index :
       {near - 1, near, near + 1}) {  // slot starts are rounded to microseconds
    if (slot_index >= 0 && slot_index < slots_ &&
        slot(plan.round, slot_index).begin == plan.slot_start) {
      return slot_index;
    }
  }
  return std::nullopt;
}

RoundSchedule::Slot RoundSchedule::proposal_slot(std::int64_t round) const {
  Slot slot = part_of(round, slot_index_, Duration{0}, budget_ / 2);
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
