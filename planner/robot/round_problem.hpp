#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/mapping/looks.hpp"
#include "models/plan/plan.hpp"
#include "planner/problem/fixed_information.hpp"
#include "planner/problem/problem.hpp"
#include "planner/robot/plan_inputs.hpp"
#include "planner/robot/workspace.hpp"

namespace vantage::planner {

/// What one robot has to decide in a slot, as a value.
struct RoundProblem {
  SearchProblem search;  ///< its world is the workspace's
  /// The first of search.teammates: those that contribute information. After them come places of
  /// teammates that wait, and bodies other than robots.
  std::vector<FixedTeammate> teammates;
  models::Looks looks;                ///< of the scenario's map; none where none was heard
  std::int64_t unusable_beliefs = 0;  ///< as PlannerCounts says
  std::int64_t unusable_maps = 0;
  std::int64_t bodies_dropped = 0;
};

/// True when the frame shows a body other than a robot as high as `robot` (by index) flies, or
/// nearer below than vehicles keep from each other: one that plans must keep from.
bool shows_bodies_in_the_way(const Workspace& workspace, std::size_t robot,
                             const models::MocapFrame& frame);

/// The problem of robot `robot` (by index) in the slot of `inputs`, from where its `committed`
/// motion begins: the targets that it believes in and the landmarks of what is unexplored (where it
/// maps: the map), the teammates' newest plans and what those see, those of the robots `unseeing`
/// (by index) and of jammed ones excepted, the places of teammates that do not follow plans, are
/// off them or have an old status, and the bodies in the way, straight on at their velocity. Equal
/// inputs give equal problems; the workspace keeps nothing of it but what spares work.
RoundProblem problem_of_round(Workspace& workspace, std::size_t robot, const PlanInputs& inputs,
                              const models::Trajectory& committed,
                              const std::vector<int>& unseeing);

}  // namespace vantage::planner
