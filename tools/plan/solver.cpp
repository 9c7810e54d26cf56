#include "tools/plan/solver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/cpu_time.hpp"

namespace vantage::tools {
namespace {

constexpr const char* kDefault = "default";
constexpr std::size_t kLeastMemory_mb = 16;
constexpr std::size_t kMostMemory_mb = std::size_t{1} << 20;

bool has_room(const planner::SearchCapacity& has, const planner::SearchCapacity& needed) {
  return needed.nodes_max <= has.nodes_max && needed.block_doubles_max <= has.block_doubles_max &&
         needed.targets_max <= has.targets_max && needed.horizon_max <= has.horizon_max &&
         needed.teammates_max <= has.teammates_max;
}

}  // namespace

Solver::Solver(PlanRequest request) : request_(std::move(request)) {
  const auto& all = planner::all_algorithms();
  if (request_.algorithm != kDefault &&
      std::none_of(all.begin(), all.end(), [&](const planner::Algorithm& each) {
        return each.name == request_.algorithm;
      })) {
    std::string names = kDefault;
    for (const planner::Algorithm& each : all) {
      names += fmt::format(", {}", each.name);
    }
    throw UsageError(
        fmt::format("algorithm: must be one of {}, got {}", names, request_.algorithm));
  }
  const auto check = [](bool holds, const char* name, const std::string& rule, auto value) {
    require(holds, fmt::format("{}: must be {}, got {}", name, rule, value));
  };
  check(request_.budget_s >= 0.0 && request_.budget_s <= kLongestBudget_s, "budget_s",
        fmt::format("≥ 0 and ≤ {}", kLongestBudget_s), request_.budget_s);
  constexpr std::int64_t kMostNodes = 1'000'000'000'000;
  const std::int64_t nodes = request_.nodes.value_or(1);
  check(nodes >= 1 && nodes <= kMostNodes, "nodes", fmt::format("≥ 1 and ≤ {}", kMostNodes), nodes);
  const planner::AlgorithmOptions& options = request_.options;
  check(std::isfinite(options.epsilon) && options.epsilon >= 0.0, "epsilon", "≥ 0",
        options.epsilon);
  check(std::isfinite(options.delta_m) && options.delta_m >= 0.0, "delta_m", "≥ 0",
        options.delta_m);
  check(options.weight >= 1.0 && options.weight <= 1e6, "weight", "≥ 1 and ≤ 1000000",
        options.weight);
  check(request_.memory_mb >= kLeastMemory_mb && request_.memory_mb <= kMostMemory_mb, "memory_mb",
        fmt::format("≥ {} and ≤ {}", kLeastMemory_mb, kMostMemory_mb), request_.memory_mb);
}

void Solver::prepare(const planner::SearchProblem& problem) {
  constexpr std::size_t kSlackNodes = 64;  // nodes that the last work unit may add
  const planner::Algorithm& algorithm = planner::algorithm_called(
      request_.algorithm == kDefault ? planner::default_algorithm(problem)
                                     : std::string_view(request_.algorithm));
  const std::size_t nodes_max = request_.nodes
                                    ? static_cast<std::size_t>(*request_.nodes) + kSlackNodes
                                    : planner::nodes_within(request_.budget_s);
  const planner::SearchCapacity needed =
      planner::capacity_for(algorithm, problem, request_.memory_mb << 20U, nodes_max);
  if (search_ == nullptr || algorithm_ != &algorithm || !has_room(capacity_, needed)) {
    search_.reset();  // frees the old arena before the new one is allocated
    search_ = algorithm.make(needed, request_.options);
    algorithm_ = &algorithm;
    capacity_ = needed;
    outcome_.algorithm = algorithm.name;
  }
}

const PlanOutcome& Solver::solve(const planner::SearchProblem& problem, bool (*is_cancelled)()) {
  prepare(problem);
  const double cpu_start_s = thread_cpu_s();
  const std::int64_t start_ns = monotonic_ns();
  const Deadline budget =
      request_.nodes ? Deadline::nodes(*request_.nodes)
                     : Deadline::at(start_ns + static_cast<std::int64_t>(1e9 * request_.budget_s));
  outcome_.result = search_->plan(problem, budget.with_cancellation(is_cancelled));
  outcome_.elapsed_s = 1e-9 * static_cast<double>(monotonic_ns() - start_ns);
  outcome_.cpu_s = thread_cpu_s() - cpu_start_s;
  outcome_.peak_bytes = search_->peak_bytes();
  outcome_.is_interrupted = is_cancelled != nullptr && is_cancelled() &&
                            outcome_.result.stop_reason == planner::StopReason::kDeadline;
  return outcome_;
}

}  // namespace vantage::tools
