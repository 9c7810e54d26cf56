#pragma once

#include <cstddef>

#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// Largest problem that a search object accepts. Its arenas are reserved for that size but take
/// memory only when first used, so small problems are cheap.
struct SearchCapacity {
  std::size_t nodes_max = 400'000;
  std::size_t block_doubles_max = 8'000'000;
  int targets_max = 64;
  int horizon_max = 32;
  int teammates_max = 16;
  /// Steps from the start until every teammate hovers and the robot's last stop has ended; 0: three
  /// horizons. A problem that needs more steps is accepted, but reset() then allocates memory.
  int motion_steps_max = 0;
};

/// @throws UsageError when `problem` has more steps, targets or teammates than `capacity`.
/// Allocates nothing unless it throws.
void require_fits(const SearchProblem& problem, const SearchCapacity& capacity);

}  // namespace vantage::planner
