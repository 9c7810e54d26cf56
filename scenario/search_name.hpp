#pragma once

#include <string>
#include <string_view>

#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// planner.algorithm of a robot that searches nothing itself: a process on the bus is asked for
/// each plan. Not one of kSearchWords, since nothing in a catalogue answers to it.
inline constexpr std::string_view kExternalSearch = "external";

inline bool is_external(const PlannerSpec& planner) { return planner.algorithm == kExternalSearch; }

/// What a team plans by, in a word for people: the algorithm, or "mapping".
inline std::string search_name(const PlannerSpec& planner) {
  const bool is_mapping = planner.objective == PlanObjective::kMapping;
  return is_mapping && !is_external(planner) ? "mapping" : planner.algorithm;
}

}  // namespace vantage::scenario
