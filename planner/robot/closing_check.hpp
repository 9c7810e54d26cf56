#pragma once

#include <cstddef>
#include <optional>

#include "models/plan/plan.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// True if `motion` keeps the required separation from the teammates of `problem`, with a tolerance
/// of `rounding_m`.
bool keeps_apart(const SearchProblem& problem, const models::Trajectory& motion, double rounding_m);

/// True if `motion` is clear of obstacles and separated from all teammates, with a tolerance of 2
/// cm. This is the closing check before a motion is published. Precondition: the problem has
/// a world.
bool is_safe(const SearchProblem& problem, const models::Trajectory& motion);

/// Returns the index of the nearest teammate that is closer than the required separation; nullopt
/// if there is none.
std::optional<std::size_t> nearest_violating_teammate(const SearchProblem& problem);

}  // namespace vantage::planner
