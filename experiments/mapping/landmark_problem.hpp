#pragma once

#include <cstdint>

#include "planner/problem/owned_problem.hpp"

namespace vantage::experiments {

/// Returns the active mapping problem of the dissertation, section 2.H: 10 × 10 m, three boxes in
/// the middle, six static landmarks (prior 0.25 I₂), an all-round range sensor (σ 0.15 m, up to 1
/// m), the ten standard primitives, T = 12, trace cost. The robot starts at `start`.
planner::OwnedProblem landmark_problem(const Pose2& start);

/// Returns the problem of landmark_problem() with a random obstacle-free start, determined by
/// `seed`.
planner::OwnedProblem random_start_problem(std::uint64_t seed);

/// Returns the problem of Fig. 2.5: one moving target, a sensor with 2 m range, no obstacles, T =
/// 6.
planner::OwnedProblem moving_target_problem();

}  // namespace vantage::experiments
