#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "planner/problem/problem.hpp"
#include "tools/plan/problem_json.hpp"
#include "tools/plan/solver.hpp"

namespace vantage::tools {

/// True if each of the T steps has a control.
bool is_complete(const planner::SearchProblem& problem, const planner::SearchResult& result);

/// Returns the object that `vantage plan --json` prints (keys: docs/guide/planning-problems.md).
/// Infinite and unknown values are null.
nlohmann::ordered_json to_json(const PlanningProblem& problem, const PlanOutcome& outcome);
/// Returns the entries of to_json() as text, one line per entry.
std::vector<std::string> to_lines(const PlanningProblem& problem, const PlanOutcome& outcome);
/// Returns advice for a plan that is not proven optimal; empty: none.
std::string hint_for(const PlanOutcome& outcome);
/// Draws map, obstacles, predicted targets with their uncertainty before and after the plan, the
/// path, and the field of view at each step. Returns SVG.
std::string draw_plan_picture(const PlanningProblem& problem, const PlanOutcome& outcome);

std::string_view word_of(planner::StopReason reason);

}  // namespace vantage::tools
