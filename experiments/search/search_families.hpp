#pragma once

#include <cstdint>
#include <vector>

#include "planner/problem/owned_problem.hpp"

namespace vantage::experiments {

/// A family of planning problems of one robot, drawn by a seed.
struct SearchFamily {
  const char* name;
  const char* what;
  planner::OwnedProblem (*draw)(std::uint64_t seed);
};

/// Returns the families of the study search-or-sampling: dense and sparse tracking, mapping of
/// landmarks, cluttered rooms, corridors, bearing-only and long horizons; 1 to 25 targets, horizons
/// of 6 to 120 s.
const std::vector<SearchFamily>& search_families();

}  // namespace vantage::experiments
