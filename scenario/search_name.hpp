#pragma once

#include <string>
#include <string_view>

#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// planner.algorithm of a robot without a search: a process on the bus is requested for each plan.
/// Not in kSearchWords because no catalogue has an entry for it.
inline constexpr std::string_view kExternalSearch = "external";

inline bool is_external(const PlannerSpec& planner) { return planner.algorithm == kExternalSearch; }

/// Returns the name of a team's planning method for reports: the algorithm, or "mapping".
inline std::string search_name(const PlannerSpec& planner) {
  const bool is_mapping = planner.objective == PlanObjective::kMapping;
  return is_mapping && !is_external(planner) ? "mapping" : planner.algorithm;
}

}  // namespace vantage::scenario
