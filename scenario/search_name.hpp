#pragma once

#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// What a team plans by, in a word for people: the algorithm, or "mapping".
inline const char* search_name(const PlannerSpec& planner) {
  return planner.objective == PlanObjective::kMapping ? "mapping" : name_of(planner.algorithm);
}

}  // namespace vantage::scenario
