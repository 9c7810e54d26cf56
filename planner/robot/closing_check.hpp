#pragma once

#include <cstddef>
#include <optional>

#include "models/plan/plan.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// Whether `motion` keeps what `problem` asks from its teammates, to within `rounding_m`.
bool keeps_apart(const SearchProblem& problem, const models::Trajectory& motion, double rounding_m);

/// The closing check of what may be published: clear of the world and apart from all teammates, to
/// within 2 cm. Precondition: the problem has a world.
bool is_safe(const SearchProblem& problem, const models::Trajectory& motion);

/// The nearest teammate that is nearer than asked for, by index; nullopt: none.
std::optional<std::size_t> too_near(const SearchProblem& problem);

}  // namespace vantage::planner
