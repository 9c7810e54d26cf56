#pragma once

#include <cstdint>

#include "planner/problem/owned_problem.hpp"

namespace vantage::experiments {

/// Active mapping of the dissertation's ch. 2 H: 10 × 10 m, three boxes in the middle, six static
/// landmarks (prior 0.25 I₂), a range sensor that sees all around (σ 0.15 m, up to 1 m), the ten
/// standard primitives, T = 12, trace cost; the robot at `start`.
planner::OwnedProblem landmark_problem(const Pose2& start);

/// The same with the start drawn anywhere free, by `seed` alone.
planner::OwnedProblem random_start_problem(std::uint64_t seed);

/// One target that moves, a range sensor of 2 m, no obstacles, T = 6: what Fig. 2.5 draws.
planner::OwnedProblem moving_target_problem();

}  // namespace vantage::experiments
