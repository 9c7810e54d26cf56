#pragma once

#include <cstdint>

#include "planner/problem/problem.hpp"

namespace vantage::bench {

struct DenseResult {
  double cost = 0.0;  ///< cost of the best plan
  std::int64_t nodes = 0;
};

/// Plans by textbook forward value iteration: every node has one dense covariance Σ over all
/// targets, Σ ← A Σ Aᵀ + W, then K = Σ Hᵀ (H Σ Hᵀ + V)⁻¹ with the rows of all visible targets
/// stacked in H; log det Σ by Cholesky. Nothing is shared or skipped. Time O(nodes · (4 M)³)
/// for M targets; memory: one matrix per node of the last but one depth.
/// Precondition: log det cost, planar targets, no teammates.
DenseResult dense_value_iteration(const planner::SearchProblem& problem);

}  // namespace vantage::bench
