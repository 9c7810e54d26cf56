#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Value of planner.algorithm for plans that a user-supplied process on the bus computes. The name
/// is not in kSearchNames, because the search catalogue does not contain such a search.
inline constexpr std::string_view kExternalSearch = "external";

inline bool is_external(const PlannerSpec& planner) { return planner.algorithm == kExternalSearch; }

/// Returns the searches that planner.algorithm may name, except kExternalSearch: kSearchNames, then
/// the searches that were added.
const std::vector<std::string>& search_names();

/// Adds a name to search_names(); planner::add_algorithm() calls this function. Not thread-safe.
/// @throws UsageError if the name is empty or already in use
void add_search_name(std::string name);

/// Returns the name of a team's planning method for reports: the algorithm, or "mapping".
inline std::string search_name(const PlannerSpec& planner) {
  const bool is_mapping = planner.objective == PlanObjective::kMapping;
  return is_mapping && !is_external(planner) ? "mapping" : planner.algorithm;
}

}  // namespace vantage::scenario
