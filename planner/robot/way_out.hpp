#pragma once

#include <optional>

#include "models/plan/plan.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// True if some motion can begin at the stationary robot's position after a turn by `turned_rad`.
bool has_way_out(const SearchProblem& problem, double turned_rad);

/// Returns a turn on the spot by an eighth of a circle for a stationary robot whose search found no
/// motion; a motion may begin after it. Turning moves no disc, so it is safe wherever hovering is.
///
/// If a teammate is too near, the robot turns away from it. Once it faces away, it keeps turning
/// until some heading allows a motion. If walls or teammates ahead block every motion, it turns
/// towards the nearest heading that allows one. nullopt if the present heading allows one, unless
/// the search disagrees (`is_boxed_in`), or if no heading does; with `is_boxed_in` it then keeps
/// turning left.
std::optional<models::Trajectory> turn_to_a_way_out(const SearchProblem& problem, bool is_boxed_in,
                                                    double yaw_rate_max_radps);

}  // namespace vantage::planner
