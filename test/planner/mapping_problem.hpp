#pragma once

#include <cstdint>

#include "test/planner/random_problem.hpp"

namespace vantage::test {

/// Active mapping of the dissertation's ch. 2 H: 10 × 10 m, three boxes in the middle, six static
/// landmarks (prior 0.25 I₂), a range sensor that sees all around (σ 0.15 m, up to 1 m), the ten
/// standard primitives, T = 12, trace cost; the robot at `start`.
OwnedProblem mapping_problem(const Pose2& start);

/// The problem whose optimum is known: 19.3554, by a search of another kind.
OwnedProblem known_mapping_problem();
inline constexpr double kKnownMappingOptimum = 19.3554;

/// The same with the start drawn anywhere free.
OwnedProblem random_mapping_problem(std::uint64_t seed);

/// The same world with `landmarks` drawn anywhere free.
OwnedProblem random_landmark_problem(std::uint64_t seed, int landmarks);

}  // namespace vantage::test
