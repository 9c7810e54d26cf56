#pragma once

#include <vector>

#include "planner/robot/plan_inputs.hpp"
#include "planner/robot/round.hpp"
#include "planner/robot/slot_colour.hpp"
#include "planner/robot/workspace.hpp"

namespace vantage::planner {

/// Selector of one robot's slot from its own and its neighbours' newest plans, if robots share
/// slots.
class SharedSlots {
 public:
  /// Precondition: the scenario's slots are shared. `workspace` must outlive this object.
  SharedSlots(const Workspace& workspace, int robot);

  /// True if this robot may search in the slot of `inputs`: its last plan was made in this slot,
  /// and no neighbour of lower index uses the slot.
  [[nodiscard]] bool has_slot(const PlanInputs& inputs) const;
  /// Returns the robot's slot in the next round, for use after publication in its current one.
  [[nodiscard]] int next_slot_index(const PlanInputs& inputs) const;

 private:
  [[nodiscard]] std::optional<int> last_slot_index(const PlanInputs& inputs) const;
  [[nodiscard]] std::vector<SlotHolder> neighbours(const PlanInputs& inputs) const;

  const Workspace& workspace_;
  int robot_;
  RoundSchedule schedule_;
};

}  // namespace vantage::planner
