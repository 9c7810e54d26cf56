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

/// Plans that are chosen from candidates, by what they tell and cost.
class CandidatePlanner : public SlotPlanner {
 protected:
  /// `workspace` must outlive it.
  CandidatePlanner(Workspace& workspace, std::size_t robot)
      : scenario_(workspace.scenario()), robot_(robot), search_(workspace.reduced()) {}

  [[nodiscard]] const scenario::Scenario& scenario() const { return scenario_; }
  [[nodiscard]] std::size_t robot() const { return robot_; }
  /// A round about candidates that are found by `deadline`; `committed` as SessionSetup's.
  std::unique_ptr<TeamExchange> round_of(const SlotTask& task,
                                         std::optional<std::vector<models::TeamChoice>> committed,
                                         const Deadline& deadline);

  /// Of a robot that rests where no motion can begin and is given none: a turn to where one can.
  /// Where a motion can begin it may rest, for none may be worth its energy. `own`: what it is
  /// given, if anything.
  [[nodiscard]] std::optional<models::RobotPlan> turned(SlotTask& task,
                                                        const models::TeamChoice* own) const;

 private:
  const scenario::Scenario& scenario_;
  std::size_t robot_;
  ReducedValueIteration& search_;
};

/// Of a robot that pays for its energy: coordinate descent over candidates, what they cost
/// included. It rests where none is worth that. The search for them has a third of the time: what
/// follows it takes tens of milliseconds.
class WorthPlanner : public CandidatePlanner {
 public:
  WorthPlanner(Workspace& workspace, std::size_t robot) : CandidatePlanner(workspace, robot) {}
  models::RobotPlan plan(SlotTask& task, const Deadline& deadline) override;
};

/// In a team that plans by local search: does what the solution in its inputs gives it, a motion
/// that passes the closing check, or rest; so does a robot without any. Source:
/// docs/decisions/0006.
class AgreedPlanner : public CandidatePlanner {
 public:
  AgreedPlanner(Workspace& workspace, std::size_t robot) : CandidatePlanner(workspace, robot) {}
  models::RobotPlan plan(SlotTask& task, const Deadline& deadline) override;
  std::unique_ptr<TeamExchange> begin_exchange(const SlotTask& task,
                                               const Deadline& deadline) override;
};

}  // namespace vantage::planner
