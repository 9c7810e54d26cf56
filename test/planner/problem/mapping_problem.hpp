#pragma once

#include <cstdint>

#include "experiments/landmark_problem.hpp"

namespace vantage::test {

/// The problem whose optimum is known: 19.3554, by a search of another kind.
planner::OwnedProblem known_mapping_problem();
inline constexpr double kKnownMappingOptimum = 19.3554;

/// Active mapping with `landmarks` drawn anywhere free, as is the start.
planner::OwnedProblem random_landmark_problem(std::uint64_t seed, int landmarks);

}  // namespace vantage::test
