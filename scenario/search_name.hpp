#pragma once

#include <string>

#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// What a team plans by, in a word for people: the algorithm, or "mapping".
inline std::string search_name(const PlannerSpec& planner) {
  return planner.objective == PlanObjective::kMapping ? "mapping" : planner.algorithm;
}

}  // namespace vantage::scenario
