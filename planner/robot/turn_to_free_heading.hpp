#pragma once

#include <optional>

#include "models/plan/plan.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// True if some motion can begin at the position of the stationary robot after a turn by
/// `turned_rad`.
bool can_move_after_turn(const SearchProblem& problem, double turned_rad);

/// Returns a turn on the spot by an eighth of a circle for a stationary robot when its search found
/// no motion; after the turn, a motion may be possible. Turning does not move the robot's disc, so
/// it is safe wherever hovering is.
///
/// If a teammate is too near, the robot turns away from the teammate. When it faces away, it
/// continues to turn until its heading allows a motion. If walls or teammates ahead block every
/// motion, it turns towards the nearest heading that allows one. nullopt if the present heading
/// allows a motion or if no heading does. If the search found no motion (`is_blocked`), the robot
/// always turns: left if no other heading allows a motion.
std::optional<models::Trajectory> turn_to_free_heading(const SearchProblem& problem,
                                                       bool is_blocked, double yaw_rate_max_radps);

}  // namespace vantage::planner
