#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "core/deadline.hpp"
#include "models/exchange/messages.hpp"
#include "planner/robot/plan_inputs.hpp"
#include "planner/robot/plan_ladder.hpp"
#include "planner/robot/planner_counts.hpp"
#include "planner/robot/round_problem.hpp"
#include "planner/robot/team_exchange.hpp"
#include "planner/robot/workspace.hpp"

namespace vantage::planner {

/// Task of one slot, with the robot's committed motion. Used for one call only.
struct SlotTask {
  const PlanInputs& inputs;
  const models::Trajectory& committed;
  const RoundProblem& round;
  PlanLadder ladder;  ///< chooser of the slot's plan
  PlannerCounts& counts;
  bool is_bait = false;  ///< true: the robot is bait and flies its proposal
};

/// Planning method of a robot's slot; selected by the scenario (make_slot_planner()).
class SlotPlanner {
 public:
  SlotPlanner() = default;
  virtual ~SlotPlanner() = default;
  SlotPlanner(const SlotPlanner&) = delete;
  SlotPlanner& operator=(const SlotPlanner&) = delete;
  SlotPlanner(SlotPlanner&&) = delete;
  SlotPlanner& operator=(SlotPlanner&&) = delete;

  /// Returns the slot's plan.
  virtual models::RobotPlan plan(SlotTask& task, const Deadline& deadline) = 0;
  /// Returns the plan of the robot as if it were alone, for a task without other robots' sensors;
  /// nullopt if the method makes no proposals.
  virtual std::optional<models::PlanProposal> propose(SlotTask& task, const Deadline& deadline);
  /// Starts the robot's part in the round's exchange, for the same task; null if the team exchanges
  /// nothing.
  virtual std::unique_ptr<TeamExchange> begin_exchange(const SlotTask& task,
                                                       const Deadline& deadline);
};

/// Creates the planner that the scenario selects: an external process for planner.algorithm
/// `external`, the agreed solution for local search, CoordinateDescentPlanner for a robot with an
/// energy price, otherwise a search. `workspace` must outlive the result.
std::unique_ptr<SlotPlanner> make_slot_planner(Workspace& workspace, std::size_t robot);

}  // namespace vantage::planner
