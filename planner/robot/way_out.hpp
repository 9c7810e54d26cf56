#pragma once

#include <optional>

#include "models/plan/plan.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// Whether some motion may begin from where the robot rests, once it has turned by so much.
bool has_way_out(const SearchProblem& problem, double turned_rad);

/// For a robot that rests and that a search leaves where it is: a turn on the spot by an eighth,
/// after which a motion may begin. Turning moves no disc, so it is safe wherever hovering is.
///
/// From a teammate that is too near it turns away or, once it faces away, on and on, until some
/// heading has a way out. Where walls or teammates are so near ahead that no motion can begin it
/// turns towards the nearest heading with a way out. nullopt where there is one already, unless the
/// search says otherwise (`is_boxed_in`: then on and on, to the left), and where there is none.
std::optional<models::Trajectory> turn_to_a_way_out(const SearchProblem& problem, bool is_boxed_in,
                                                    double yaw_rate_max_radps);

}  // namespace vantage::planner
