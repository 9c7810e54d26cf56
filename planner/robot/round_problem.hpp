#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/mapping/cell_counts.hpp"
#include "models/plan/plan.hpp"
#include "planner/problem/fixed_information.hpp"
#include "planner/problem/problem.hpp"
#include "planner/robot/plan_inputs.hpp"
#include "planner/robot/workspace.hpp"

namespace vantage::planner {

/// One robot's decision problem in a slot, as a value.
struct RoundProblem {
  SearchProblem search;  ///< search problem; its world belongs to the workspace
  /// Teammates that contribute information: the first entries of search.teammates. The later
  /// entries are positions of waiting teammates, and bodies other than robots.
  std::vector<FixedTeammate> teammates;
  models::CellCounts looks;           ///< look counts of the map; empty if none was received
  std::int64_t unusable_beliefs = 0;  ///< see PlannerCounts
  std::int64_t unusable_maps = 0;
  std::int64_t bodies_dropped = 0;
};

/// True if the frame shows a body that robot `robot` (by index) must avoid: one that is not a robot
/// and is at the robot's height, or below it by less than the separation distance.
bool shows_bodies_in_the_way(const Workspace& workspace, std::size_t robot,
                             const models::MocapFrame& frame);

/// Returns the problem of robot `robot` (by index) in the slot of `inputs`, starting where its
/// `committed` motion begins. It contains the believed targets and the landmarks of unexplored
/// areas (or the map, in mapping). It contains the teammates' newest plans and their information,
/// except from jammed robots and `robots_without_sensing` (by index). It also contains the
/// positions of teammates that do not follow plans, are off their plan or have an old status.
/// Bodies in the way are assumed to move at constant velocity. Equal inputs give equal problems;
/// the workspace only caches computations.
RoundProblem problem_of_round(Workspace& workspace, std::size_t robot, const PlanInputs& inputs,
                              const models::Trajectory& committed,
                              const std::vector<int>& robots_without_sensing);

}  // namespace vantage::planner
