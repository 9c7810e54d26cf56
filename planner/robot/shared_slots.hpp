#pragma once

#include <vector>

#include "planner/robot/plan_inputs.hpp"
#include "planner/robot/round.hpp"
#include "planner/robot/slot_colour.hpp"
#include "planner/robot/workspace.hpp"

namespace vantage::planner {

/// Which slot of a round is one robot's, where robots share them: by what its own and its
/// neighbours' newest plans say.
class SharedSlots {
 public:
  /// Precondition: the scenario's slots are shared. `workspace` must outlive it.
  SharedSlots(const Workspace& workspace, int robot);

  /// Whether the slot of `inputs` is this robot's alone among its neighbours.
  [[nodiscard]] bool has_slot(const PlanInputs& inputs) const;
  /// Which slot of the next round is the robot's, after it has published in its last one.
  [[nodiscard]] int next_place(const PlanInputs& inputs) const;

 private:
  [[nodiscard]] std::optional<int> last_place(const PlanInputs& inputs) const;
  [[nodiscard]] std::vector<SlotHolder> neighbours(const PlanInputs& inputs) const;

  const Workspace& workspace_;
  int robot_;
  RoundSchedule schedule_;
};

}  // namespace vantage::planner
