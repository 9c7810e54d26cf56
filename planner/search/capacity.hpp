#pragma once

#include <cstddef>

#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// How large a problem a search object is built for. Its arenas are reserved for the largest and
/// take memory as it is first used: small problems cost little however much is reserved.
struct SearchCapacity {
  std::size_t nodes_max = 400'000;
  std::size_t block_doubles_max = 8'000'000;
  int targets_max = 64;
  int horizon_max = 32;
  int teammates_max = 16;
};

/// @throws UsageError when `problem` has more steps, targets or teammates. Allocates nothing unless
/// it throws.
void require_fits(const SearchProblem& problem, const SearchCapacity& capacity);

}  // namespace vantage::planner
