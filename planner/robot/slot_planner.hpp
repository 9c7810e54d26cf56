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

/// What is to be decided in a slot, once it is known what the robot is committed to. Good for one
/// call.
struct SlotTask {
  const PlanInputs& inputs;
  const models::Trajectory& committed;
  const RoundProblem& round;
  PlanLadder ladder;  ///< of the slot's plan
  PlannerCounts& counts;
  bool is_bait = false;  ///< it does as it has proposed
};

/// How a robot comes to the plan of its slot; a scenario says which it is (make_slot_planner()).
class SlotPlanner {
 public:
  SlotPlanner() = default;
  virtual ~SlotPlanner() = default;
  SlotPlanner(const SlotPlanner&) = delete;
  SlotPlanner& operator=(const SlotPlanner&) = delete;
  SlotPlanner(SlotPlanner&&) = delete;
  SlotPlanner& operator=(SlotPlanner&&) = delete;

  /// The slot's plan.
  virtual models::RobotPlan plan(SlotTask& task, const Deadline& deadline) = 0;
  /// What the robot would do alone, of a task in which nobody else sees; nullopt: it never says.
  virtual std::optional<models::PlanProposal> propose(SlotTask& task, const Deadline& deadline);
  /// Its part in the round's exchange, of the same task; null: its team exchanges nothing.
  virtual std::unique_ptr<TeamExchange> begin_exchange(const SlotTask& task,
                                                       const Deadline& deadline);
};

/// The one that the scenario asks for: planner.algorithm `external` asks another process, a team
/// that plans by local search flies what it has agreed on, a robot that pays for its energy weighs
/// candidates, all others search. `workspace` must outlive it.
std::unique_ptr<SlotPlanner> make_slot_planner(Workspace& workspace, std::size_t robot);

}  // namespace vantage::planner
