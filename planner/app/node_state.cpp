#include "planner/app/node_state.hpp"

#include <algorithm>

#include "bus/convert/external_channels.hpp"
#include "scenario/node_budget.hpp"

namespace vantage::planner {
namespace {

// Time reserved at the end of a slot. The plan must be complete, checked and sent before the slot
// ends, despite scheduler stalls (8 ms is usual on a virtual machine, 24 ms under load).
constexpr Duration kClosing{20'000};

}  // namespace

Time NodeState::work_end() const {
  return inputs.slot.end - std::min(kClosing, (inputs.slot.end - inputs.slot.begin) / 5);
}

std::int64_t NodeState::node_budget() const {
  return spec.node_budget > 0 ? spec.node_budget : scenario::kDefaultNodeBudget;
}

Deadline NodeState::deadline(Time now) const {
  if (!clock.is_real_time() || spec.node_budget > 0) {
    return Deadline::nodes(node_budget());
  }
  const Duration left = std::max(work_end() - now, Duration{0});
  return Deadline::at(monotonic_ns() + left.count() * 1'000);
}

std::vector<models::InputRef> names_of(const PlanInputs& inputs, const std::string& robot) {
  std::vector<models::InputRef> names;
  const auto add = [&](const std::string& channel, const models::Stamp& stamp) {
    names.push_back(models::ref_to(channel, stamp));
  };
  if (inputs.belief) {
    add(bus::belief_channel(robot).name, inputs.belief->stamp);
  }
  if (inputs.mixture) {
    add(bus::mixture_channel(robot).name, inputs.mixture->stamp);
  }
  if (inputs.map) {
    add(bus::map_channel(robot).name, inputs.map->stamp);
  }
  if (inputs.mocap) {
    add(bus::kVicon.name, inputs.mocap->stamp);
  }
  for (const auto& [of_robot, pose] : inputs.poses) {
    add(bus::pose_channel(of_robot).name, pose.stamp);
  }
  if (inputs.mocap_before) {
    add(bus::kVicon.name, inputs.mocap_before->stamp);
  }
  if (inputs.own_plan) {
    add(bus::plan_channel(robot).name, inputs.own_plan->stamp);
  }
  for (const auto& [teammate, plan] : inputs.team_plans) {
    add(bus::plan_channel(teammate).name, plan.stamp);
  }
  for (const auto& [teammate, status] : inputs.team_statuses) {
    add(bus::vehicle_channel(teammate).name, status.stamp);
  }
  for (const auto& [proposer, proposal] : inputs.proposals) {
    if (proposal.plan.round == inputs.slot.round) {
      add(bus::proposal_channel(proposer).name, proposal.stamp);
    }
  }
  if (inputs.solution && inputs.solution->round == inputs.slot.round) {
    add(bus::team_proposal_channel(inputs.solution->robot).name, inputs.solution->stamp);
  }
  if (inputs.answer && inputs.answer->round == inputs.slot.round) {
    add(bus::external_plan_channel(robot).name, inputs.answer->stamp);
  }
  if (inputs.attack) {
    add(bus::kAttack.name, inputs.attack->stamp);
  }
  return names;
}

}  // namespace vantage::planner
