#pragma once

#include <cstdint>

#include "planner/problem/problem.hpp"

namespace vantage::bench {

struct DenseResult {
  double cost = 0.0;  ///< of the best plan
  std::int64_t nodes = 0;
};

/// Forward value iteration as the textbook has it: every node carries one dense covariance Σ over
/// all targets, Σ ← A Σ Aᵀ + W, then K = Σ Hᵀ (H Σ Hᵀ + V)⁻¹ with the rows of all targets in sight
/// stacked in H; log det Σ by Cholesky. Nothing shared, nothing skipped. O(nodes · (4 M)³), and as
/// many matrices in memory as the last but one depth has nodes.
/// Precondition: log det cost, planar targets, no teammates.
DenseResult dense_value_iteration(const planner::SearchProblem& problem);

}  // namespace vantage::bench
