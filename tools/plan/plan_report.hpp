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

/// True when every one of the T steps has a control.
bool is_complete(const planner::SearchProblem& problem, const planner::SearchResult& result);

/// The object that `vantage plan --json` prints (keys: docs/guide/planning-problems.md). What is infinite
/// or not known is null.
nlohmann::ordered_json to_json(const PlanningProblem& problem, const PlanOutcome& outcome);
/// The same for people, one line an entry.
std::vector<std::string> to_lines(const PlanningProblem& problem, const PlanOutcome& outcome);
/// Map, obstacles, predicted targets with their uncertainty before and after, path, and the field
/// of view at every step, as SVG.
std::string draw_plan_picture(const PlanningProblem& problem, const PlanOutcome& outcome);

std::string_view word_of(planner::StopReason reason);

}  // namespace vantage::tools
