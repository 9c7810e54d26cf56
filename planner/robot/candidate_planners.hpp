#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "models/exchange/messages.hpp"
#include "planner/robot/slot_planner.hpp"
#include "planner/search/arvi.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Base of planners that choose a plan from candidates by information gain and energy cost.
class CandidatePlanner : public SlotPlanner {
 protected:
  /// `workspace` must outlive this object.
  CandidatePlanner(Workspace& workspace, std::size_t robot)
      : scenario_(workspace.scenario()), robot_(robot), search_(workspace.reduced()) {}

  [[nodiscard]] const scenario::Scenario& scenario() const { return scenario_; }
  [[nodiscard]] std::size_t robot() const { return robot_; }
  /// Starts an exchange round on candidates found by `deadline`; `committed` as in SessionSetup.
  std::unique_ptr<TeamExchange> round_of(const SlotTask& task,
                                         std::optional<std::vector<models::TeamChoice>> committed,
                                         const Deadline& deadline);

  /// Returns a turn on the spot to a heading from which a motion can begin. The turn is needed if
  /// the robot would stay and its present heading allows no motion. Otherwise returns nullopt,
  /// because staying may then be optimal. `own`: the robot's assigned motion, or null.
  [[nodiscard]] std::optional<models::RobotPlan> turned(SlotTask& task,
                                                        const models::TeamChoice* own) const;

 private:
  const scenario::Scenario& scenario_;
  std::size_t robot_;
  ReducedValueIteration& search_;
};

/// Planner of a robot with an energy price: coordinate descent over candidates, including their
/// costs. The robot stays if no candidate has a positive value. The candidate search uses a third
/// of the time; the other steps take tens of milliseconds.
class CoordinateDescentPlanner : public CandidatePlanner {
 public:
  CoordinateDescentPlanner(Workspace& workspace, std::size_t robot)
      : CandidatePlanner(workspace, robot) {}
  models::RobotPlan plan(SlotTask& task, const Deadline& deadline) override;
};

/// Planner of a robot in a team that uses local search. Chooses the motion that the team solution
/// in its inputs assigns to the robot, if the motion passes the closing check. A robot without an
/// assigned motion stops and hovers. Source: docs/decisions/0006.
class TeamSolutionPlanner : public CandidatePlanner {
 public:
  TeamSolutionPlanner(Workspace& workspace, std::size_t robot)
      : CandidatePlanner(workspace, robot) {}
  models::RobotPlan plan(SlotTask& task, const Deadline& deadline) override;
  std::unique_ptr<TeamExchange> begin_exchange(const SlotTask& task,
                                               const Deadline& deadline) override;
};

}  // namespace vantage::planner
