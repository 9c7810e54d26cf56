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

/// One robot's part of a planning round, as a function of its inputs (and, for the sweeping
/// baseline, of the sweep's progress). Reads no clock: the caller decides whether a plan is late.
///
/// The robot plans from its committed position at t_{k+1} (commitment_of()) with the method that
/// the scenario selects (make_slot_planner()). The problem contains the teammates' newest plans,
/// their information and their swept motion (problem_of_round()). A silent teammate is assumed to
/// continue its last plan, which ends in a hover. If a teammate reports that it does not follow
/// plans, its present position is also avoided. The published plan is the first safe one of: the
/// found plan, the last plan shifted, braking to a hover (PlanLadder). A restarted planner does not
/// know the plan that its robot flies, but every teammate does. The planner waits until that plan
/// has ended in its hover, and plans from the hover.
///
/// With shared slots the robot continues its committed motion without a search in two cases: a
/// neighbour of lower index has the same slot, or this is its first round in a new slot.
///
/// If the team expects attacks (planner.attacks_max = α > 0), each robot first proposes its plan
/// alone. The α robots with the most valuable proposals are the bait and fly their proposals; the
/// others plan as if the bait had no sensors. Source: dissertation Alg. 9, 10 (RAIN). In a team
/// with local search (planner.team_algorithm) robots exchange team solutions instead; each robot
/// flies its part of the best known solution.
class RobotPlanner {
 public:
  RobotPlanner(const scenario::Scenario& scenario, const std::string& robot);
  /// Creates one of several planners that take turns in one workspace.
  RobotPlanner(std::shared_ptr<Workspace> workspace, const std::string& robot);

  /// Commits the first part of the search's memory: fewer page faults occur in real time.
  void prefault() { workspace_->prefault(); }

  /// Returns the plan of this slot. nullopt until the robot's pose is known, and while the robot
  /// flies a plan from before a restart.
  std::optional<models::RobotPlan> plan(const PlanInputs& inputs, const Deadline& deadline);

  /// Returns the robot's plan for this slot's round as if no other robot had sensors; it still
  /// avoids the teammates' committed motions. nullopt if plan() returns nullopt, and for planning
  /// methods without proposals.
  std::optional<models::PlanProposal> propose(const PlanInputs& inputs, const Deadline& deadline);

  /// Local search: starts the robot's part in the exchange of this slot's round, with candidates
  /// found by `deadline`. This planner must outlive the result. Null if plan() returns nullopt, and
  /// in teams without local search.
  std::unique_ptr<TeamExchange> begin_exchange(const PlanInputs& inputs, const Deadline& deadline);

  /// For planner.algorithm `external`: returns the request to the external process. The request is
  /// the committed motion from t_{k+1} on, as a plan without a search; an answer must start at the
  /// same pose and time. nullopt if plan() returns nullopt. Counts nothing.
  [[nodiscard]] std::optional<models::RobotPlan> external_request(const PlanInputs& inputs) const;

  /// Returns the plan to publish when the search ended after its slot. The result continues the old
  /// plan, on which teammates may already rely and with which every other committed plan is
  /// compatible.
  std::optional<models::RobotPlan> plan_without_search(const PlanInputs& inputs);

  /// Returns braking to a hover instead of a search, before the deadline, because the process gets
  /// too little processor time to keep its commitments. The plan is published with `late` set
  /// although its deadline has not passed; replays recognise such plans by this combination.
  std::optional<models::RobotPlan> plan_to_stop(const PlanInputs& inputs);

  /// Returns the robot's slot in the next round, for use after publication in its current one;
  /// nullopt if slots are not shared.
  [[nodiscard]] std::optional<int> next_slot_index(const PlanInputs& inputs) const;

  [[nodiscard]] const PlannerCounts& counts() const { return counts_; }
  [[nodiscard]] int robot_index() const { return static_cast<int>(robot_); }
  [[nodiscard]] int robot_count() const { return static_cast<int>(scenario_.robots.size()); }

  /// Returns the problem of the last plan(), for plots and tests.
  [[nodiscard]] const SearchProblem& problem() const { return round_.search; }

 private:
  [[nodiscard]] models::RobotPlan blank_plan_of(const PlanInputs& inputs) const;
  /// Returns the robot's committed motion; nullopt, and counted, if it has none.
  std::optional<models::Trajectory> committed_motion(const PlanInputs& inputs);
  /// Returns the slot's task for a problem that ignores the sensors of `robots_without_sensing`.
  SlotTask task_of(const PlanInputs& inputs, const models::Trajectory& committed,
                   const std::vector<int>& robots_without_sensing);
  /// Returns the slot's task for a plan without a search; received proposals are used.
  SlotTask task_without_search(const PlanInputs& inputs, const models::Trajectory& committed);
  /// Computes the resilient round from the received proposals of the slot's round.
  [[nodiscard]] ResilientRound resilient_round_of(const PlanInputs& inputs) const;
  [[nodiscard]] std::vector<int> all_robots() const;

  std::shared_ptr<Workspace> workspace_;
  const scenario::Scenario& scenario_;  ///< scenario of the workspace
  std::size_t robot_ = 0;               ///< index of this robot in the scenario
  std::optional<SharedSlots> slots_;    ///< set only if slots are shared
  std::unique_ptr<SlotPlanner> slot_planner_;
  RoundProblem round_;
  PlannerCounts counts_;
};

}  // namespace vantage::planner
