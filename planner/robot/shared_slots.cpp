#include "planner/robot/shared_slots.hpp"

#include <optional>

namespace vantage::planner {

SharedSlots::SharedSlots(const Workspace& workspace, int robot)
    : workspace_(workspace),
      robot_(robot),
      schedule_(workspace.scenario().planner, robot,
                static_cast<int>(workspace.scenario().robots.size())) {}

std::optional<int> SharedSlots::last_slot_index(const PlanInputs& inputs) const {
  return inputs.own_plan ? schedule_.slot_index_of(*inputs.own_plan) : std::nullopt;
}

std::vector<SlotHolder> SharedSlots::neighbours(const PlanInputs& inputs) const {
  std::vector<SlotHolder> holders;
  for (const auto& [name, plan] : inputs.team_plans) {
    const std::optional<std::size_t> robot = workspace_.index_of(name);
    const std::optional<int> slot = schedule_.slot_index_of(plan);
    if (robot && slot) {
      holders.push_back({static_cast<int>(*robot), *slot});
    }
  }
  return holders;
}

bool SharedSlots::has_slot(const PlanInputs& inputs) const {
  return last_slot_index(inputs) == inputs.slot.slot_index &&
         may_search({robot_, inputs.slot.slot_index}, neighbours(inputs));
}

int SharedSlots::next_slot_index(const PlanInputs& inputs) const {
  return next_slot({robot_, last_slot_index(inputs).value_or(schedule_.first_slot_index())},
                   neighbours(inputs), schedule_.slots());
}

}  // namespace vantage::planner
