#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "planner/search/beam.hpp"
#include "planner/search/catalogue.hpp"
#include "tools/plan/problem_json.hpp"

namespace vantage::bench {

/// One search of the study, with its arena prepared for all problems.
struct StudyMethod {
  std::string name;
  std::function<const planner::SearchResult&(const planner::SearchProblem&, const Deadline&)> plan;
};

/// Returns the method `name` of planner::all_algorithms(); "beam" takes its options from `beam`.
/// "rvi" searches once with ε = ∞ and δ = 0.663 m on the position only, which is equivalent to δ =
/// 1.2 in the metric of the reference.
StudyMethod make_method(const std::string& name, const planner::BeamOptions& beam,
                        const planner::SearchCapacity& capacity);

/// The result of a method on one problem within one budget.
struct StudyRun {
  std::string problem;
  int targets = 0;
  std::string method;
  double budget_s = 0.0;
  double cost = std::numeric_limits<double>::infinity();  ///< +∞: no complete plan
  double lower_bound = -std::numeric_limits<double>::infinity();
  double cpu_s = 0.0;
  std::vector<int> controls;
};

/// Returns the best result within `budget_s` of the thread's CPU time. The machine may be busy, so
/// budgets are converted to nodes, and the longest of a few runs within the budget is used.
/// `nodes_per_s` is the initial rate and receives the measured one. Budgets of one second or more
/// get at most two runs.
StudyRun run_within(const tools::PlanningProblem& drawn, const StudyMethod& method, double budget_s,
                    double& nodes_per_s);

}  // namespace vantage::bench
