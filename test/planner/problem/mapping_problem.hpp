#pragma once

#include <cstdint>

#include "experiments/mapping/landmark_problem.hpp"

namespace vantage::test {

/// Returns a problem with an optimum that is known from a different search, 19.3554.
planner::OwnedProblem known_mapping_problem();
inline constexpr double kKnownMappingOptimum = 19.3554;

/// Returns an active mapping problem with `landmarks` and the start at random free positions.
planner::OwnedProblem random_landmark_problem(std::uint64_t seed, int landmarks);

}  // namespace vantage::test
