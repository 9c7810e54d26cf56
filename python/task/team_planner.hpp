#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "python/task/mapping_task.hpp"
#include "python/task/team_task.hpp"
#include "python/task/tracking_task.hpp"
#include "tools/plan/solver.hpp"

namespace vantage::python {

/// Planner as a policy for a task: the robots plan in order, each given the plans of the previous
/// robots (coordinate descent).
class TeamPlanner {
 public:
  virtual ~TeamPlanner() = default;
  /// Returns the controls of each robot from its current pose on, [robot][step]; empty for a robot
  /// without a plan.
  virtual std::vector<std::vector<std::int64_t>> plan(const TeamTask& task) = 0;
};

struct TeamPlannerSpec {
  /// Tracking: a name of planner::all_algorithms(); mapping: "forward".
  std::string algorithm = "arvi";
  int horizon_steps = 12;
  std::int64_t nodes = 2'000;  ///< budget of work nodes for each robot's search (tracking)
};

/// Creates a planner for tasks like `task`. In tracking the searches use the team's beliefs instead
/// of the truth, and ignore observations from less than experiments::kPlannedRangeMin_m.
/// @throws UsageError for an algorithm that does not exist for this kind of task.
std::unique_ptr<TeamPlanner> make_team_planner(const TeamTask& task, const TeamPlannerSpec& spec);

}  // namespace vantage::python
