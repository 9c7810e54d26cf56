#pragma once

#include <string>
#include <string_view>

#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Value of planner.algorithm with which a user-supplied process on the bus computes each plan. It
/// is not in kSearchWords, because the search catalogue does not contain it.
inline constexpr std::string_view kExternalSearch = "external";

inline bool is_external(const PlannerSpec& planner) { return planner.algorithm == kExternalSearch; }

/// Returns the name of a team's planning method for reports: the algorithm, or "mapping".
inline std::string search_name(const PlannerSpec& planner) {
  const bool is_mapping = planner.objective == PlanObjective::kMapping;
  return is_mapping && !is_external(planner) ? "mapping" : planner.algorithm;
}

}  // namespace vantage::scenario
