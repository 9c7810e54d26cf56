#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "planner/robot/round_search.hpp"
#include "planner/robot/slot_planner.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Planner that searches, given the teammates' newest plans (coordinate descent). In a team that
/// expects attacks, it ignores the sensors of the bait; a bait robot flies its proposal. A
/// stationary robot without a feasible motion turns towards a free direction. Source: dissertation
/// Alg. 9, 10 (RAIN).
class SearchingPlanner : public SlotPlanner {
 public:
  /// `workspace` must outlive this object.
  SearchingPlanner(Workspace& workspace, std::size_t robot)
      : spec_(workspace.scenario().robots[robot]), search_(make_round_search(workspace, robot)) {}
  models::RobotPlan plan(SlotTask& task, const Deadline& deadline) override;
  std::optional<models::PlanProposal> propose(SlotTask& task, const Deadline& deadline) override;

 private:
  const scenario::RobotSpec& spec_;
  std::unique_ptr<RoundSearch> search_;
};

}  // namespace vantage::planner
