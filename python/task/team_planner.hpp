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

/// The stack's planners as policies for the tasks: the robots plan in their order, each against the
/// plans of those before it (coordinate descent).
class TeamPlanner {
 public:
  virtual ~TeamPlanner() = default;
  /// Controls of each robot from where it is now, [robot][step]; a robot without a plan has none.
  virtual std::vector<std::vector<std::int64_t>> plan(const TeamTask& task) = 0;
};

struct TeamPlannerSpec {
  std::string algorithm = "arvi";  ///< tracking: of planner::all_algorithms(); mapping: "forward"
  int horizon_steps = 12;
  std::int64_t nodes = 2'000;  ///< of work, of each robot's search (tracking)
};

/// A planner for tasks like `task`. Of tracking its searches know what the team believes, not what
/// is true, and count no look from nearer than 3 m (experiments::TrackingSetting says why).
/// @throws UsageError for an algorithm that the kind of task does not have.
std::unique_ptr<TeamPlanner> make_team_planner(const TeamTask& task, const TeamPlannerSpec& spec);

}  // namespace vantage::python
