#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/deadline.hpp"
#include "models/exchange/messages.hpp"
#include "planner/decision/resilient.hpp"
#include "planner/robot/plan_inputs.hpp"
#include "planner/robot/planner_counts.hpp"
#include "planner/robot/round.hpp"
#include "planner/robot/round_problem.hpp"
#include "planner/robot/shared_slots.hpp"
#include "planner/robot/slot_planner.hpp"
#include "planner/robot/team_exchange.hpp"
#include "planner/robot/workspace.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// One robot's share of a planning round, as a function of its inputs (and, for the sweeping
/// baseline, of how far the sweep has got). Knows no clock: the caller says whether it was late.
///
/// The robot plans from where its committed plan has it at t_{k+1} (commitment_of()), against the
/// teammates' newest plans, their information and their swept motion (problem_of_round()), in the
/// way that the scenario asks for (make_slot_planner()). A teammate that is silent is taken to go
/// on with its last plan, whose end is a hover; from one that says it does not follow plans its own
/// place is kept free as well. What it publishes is the first of these that is safe: what it found,
/// the last plan, shifted, or braking to a hover (PlanLadder).
///
/// A planner that was started anew does not know what its robot flies, but every teammate does: it
/// waits until that plan has come to its hover, and plans from there.
///
/// Where slots are shared it searches in its slot only if no neighbour of lower index has it, and
/// not in the first round after it took it; else it goes on with what it is committed to.
///
/// In a team that expects attacks (planner.attacks_max = α > 0) each robot first proposes what it
/// would do alone. The α proposals of greatest value are the bait: those robots do as they
/// proposed, and the others plan as if the bait saw nothing. Source: dissertation Alg. 9, 10
/// (RAIN). In a team that plans by local search (planner.team_algorithm) robots exchange proposals
/// instead, and each plan does what the solution of its inputs gives the robot.
class RobotPlanner {
 public:
  RobotPlanner(const scenario::Scenario& scenario, const std::string& robot);
  /// One of several planners that take turns in one workspace.
  RobotPlanner(std::shared_ptr<Workspace> workspace, const std::string& robot);

  /// For real time: no page of the search's memory is faulted in later.
  void prefault() { workspace_->prefault(); }

  /// The plan of this slot. nullopt while the robot's pose was never known, and
  /// while it flies a plan from before a restart.
  std::optional<models::RobotPlan> plan(const PlanInputs& inputs, const Deadline& deadline);

  /// What the robot would do in this slot's round if it were the only one that looks; the
  /// teammates' committed motions are kept clear of. nullopt where plan() is, and for a robot that
  /// searches nothing for itself.
  std::optional<models::PlanProposal> propose(const PlanInputs& inputs, const Deadline& deadline);

  /// Local search: the robot's part in the exchange of this slot's round, with candidates that are
  /// found by `deadline`; this planner must outlive it. Null where plan() is nullopt, and in teams
  /// that plan otherwise.
  std::unique_ptr<TeamExchange> begin_exchange(const PlanInputs& inputs, const Deadline& deadline);

  /// Of planner.algorithm `external`: what another process is asked. The committed motion from
  /// t_{k+1} on, as a plan that nobody searched; an answer begins where it does. nullopt where
  /// plan() is. Counts nothing.
  [[nodiscard]] std::optional<models::RobotPlan> question(const PlanInputs& inputs) const;

  /// What to publish instead when the search ended after its slot: teammates may already count on
  /// the old plan, which every other committed plan is compatible with.
  std::optional<models::RobotPlan> plan_without_search(const PlanInputs& inputs);

  /// Brakes to a hover instead of searching, in time, because the process gets too little of its
  /// machine to know what it is committed to for much longer. Published as `late` before its
  /// deadline, which no other plan is: so replays know it.
  std::optional<models::RobotPlan> plan_to_stop(const PlanInputs& inputs);

  /// Which slot of the next round is the robot's, after it has published in its last one; nullopt
  /// where slots are not shared.
  [[nodiscard]] std::optional<int> next_place(const PlanInputs& inputs) const;

  [[nodiscard]] const PlannerCounts& counts() const { return counts_; }
  [[nodiscard]] int robot_index() const { return static_cast<int>(robot_); }
  [[nodiscard]] int robot_count() const { return static_cast<int>(scenario_.robots.size()); }

  /// The problem of the last plan(), for pictures and tests.
  [[nodiscard]] const SearchProblem& problem() const { return round_.search; }

 private:
  [[nodiscard]] models::RobotPlan blank_plan_of(const PlanInputs& inputs) const;
  /// The motion that the robot is committed to; nullopt, and counted, where it has none.
  std::optional<models::Trajectory> committed_motion(const PlanInputs& inputs);
  /// The slot's task, about a problem that does not count on what `unseeing` robots see.
  SlotTask task_of(const PlanInputs& inputs, const models::Trajectory& committed,
                   const std::vector<int>& unseeing);
  /// The slot's task as the proposals make it, of a plan that is not searched.
  SlotTask task_without_search(const PlanInputs& inputs, const models::Trajectory& committed);
  /// What the proposals of the slot's round that were heard make of it.
  [[nodiscard]] ResilientRound resilient_round_of(const PlanInputs& inputs) const;
  [[nodiscard]] std::vector<int> all_robots() const;

  std::shared_ptr<Workspace> workspace_;
  const scenario::Scenario& scenario_;  ///< the workspace's
  std::size_t robot_ = 0;               ///< by index
  std::optional<SharedSlots> slots_;    ///< where they are shared
  std::unique_ptr<SlotPlanner> slot_planner_;
  RoundProblem round_;
  PlannerCounts counts_;
};

}  // namespace vantage::planner
