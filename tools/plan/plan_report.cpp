#include "tools/plan/plan_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace vantage::tools {
namespace {

nlohmann::ordered_json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

std::string_view stop_word(const PlanOutcome& outcome) {
  return outcome.is_interrupted ? "interrupted" : word_of(outcome.result.stop_reason);
}

double gap_of(const planner::SearchResult& result) {
  return std::max(0.0, result.cost - result.lower_bound);
}

}  // namespace

std::string_view word_of(planner::StopReason reason) {
  switch (reason) {
    case planner::StopReason::kFinished:
      return "finished";
    case planner::StopReason::kDeadline:
      return "deadline";
    case planner::StopReason::kMemory:
      return "memory";
    case planner::StopReason::kConverged:
      return "converged";
  }
  return "";
}

bool is_complete(const planner::SearchProblem& problem, const planner::SearchResult& result) {
  return result.found && result.moving_steps == problem.horizon_steps;
}

nlohmann::ordered_json to_json(const PlanningProblem& problem, const PlanOutcome& outcome) {
  const planner::SearchResult& result = outcome.result;
  const bool complete = is_complete(problem.problem, result);
  nlohmann::ordered_json states = nlohmann::ordered_json::array();
  for (std::size_t t = 0; t < result.controls.size(); ++t) {
    const Pose2& pose = result.poses[t];
    states.push_back({pose.x_m, pose.y_m, pose.yaw_rad});
  }
  return {{"problem", problem.name.empty() ? outcome.source : problem.name},
          {"algorithm", outcome.algorithm},
          {"found", complete},
          {"cost", complete ? number_or_null(result.cost) : nullptr},
          {"lower_bound", number_or_null(result.lower_bound)},
          {"gap", complete ? number_or_null(gap_of(result)) : nullptr},
          {"epsilon", number_or_null(result.epsilon)},
          {"delta", number_or_null(result.delta_m)},
          {"controls", result.controls},
          {"states", states},
          {"nodes_generated", result.nodes_generated},
          {"nodes_expanded", result.nodes_expanded},
          {"work_nodes", result.work_nodes},
          {"passes", result.passes},
          {"elapsed_s", outcome.elapsed_s},
          {"cpu_s", outcome.cpu_s},
          {"peak_bytes", outcome.peak_bytes},
          {"stop_reason", stop_word(outcome)}};
}

std::vector<std::string> to_lines(const PlanningProblem& problem, const PlanOutcome& outcome) {
  const planner::SearchResult& result = outcome.result;
  const auto number = [](double value) {
    return std::isfinite(value) ? fmt::format("{:.6f}", value) : std::string("none");
  };
  const std::string unit = problem.problem.cost == planner::CostKind::kLogDet ? " nats" : " m²";
  std::vector<std::string> lines;
  if (is_complete(problem.problem, result)) {
    lines.push_back("cost      " + number(result.cost) + unit);
    lines.push_back("bound     " + number(result.lower_bound) + unit);
    lines.push_back("gap       " + number(gap_of(result)) + unit);
  } else {
    lines.push_back(fmt::format("no complete plan: {} of {} steps", result.controls.size(),
                                problem.problem.horizon_steps));
  }
  lines.push_back(fmt::format("controls  {}", fmt::join(result.controls, " ")));
  lines.push_back(fmt::format("search    {}: {}, {} generated, {} expanded, {} passes",
                              outcome.algorithm, stop_word(outcome), result.nodes_generated,
                              result.nodes_expanded, result.passes));
  lines.push_back(fmt::format("time      {:.6f} s, CPU {:.6f} s, {:.1f} MB", outcome.elapsed_s,
                              outcome.cpu_s, 1e-6 * static_cast<double>(outcome.peak_bytes)));
  return lines;
}

std::string hint_for(const PlanOutcome& outcome) {
  const bool is_proven =
      outcome.result.stop_reason == planner::StopReason::kFinished || gap_of(outcome.result) <= 0.0;
  return is_proven || outcome.is_interrupted || outcome.algorithm == "astar"
             ? ""
             : "the bound is loose; --algorithm astar proves the optimum if its search completes, "
               "which is likely for few steps and targets";
}

}  // namespace vantage::tools
