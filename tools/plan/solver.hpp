#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "planner/problem/problem.hpp"
#include "planner/search/catalogue.hpp"

namespace vantage::tools {

inline constexpr double kLongestBudget_s = 86'400.0;

/// How a planning problem is to be solved.
struct PlanRequest {
  std::string algorithm =
      "default";          ///< of planner::all_algorithms(), or "default": what fits the problem
  double budget_s = 1.0;  ///< time for the search alone
  std::optional<std::int64_t> nodes;  ///< instead of time: the same answer to the bit, every time
  planner::AlgorithmOptions options;
  std::size_t memory_mb = 512;  ///< most memory of the search
};

/// One search that was run, and what it took.
struct PlanOutcome {
  std::string source;  ///< what the problem was read from; the caller's
  std::string algorithm;
  planner::SearchResult result;
  double elapsed_s = 0.0;       ///< wall clock of the search alone
  double cpu_s = 0.0;           ///< of the searching thread, the same span
  std::size_t peak_bytes = 0;   ///< nodes, blocks and lists in use
  bool is_interrupted = false;  ///< by who asked for it, before the budget was spent
};

/// Solves problem after problem with memory that is prepared once: what `vantage plan` and Python
/// share. One thread at a time.
class Solver {
 public:
  /// @throws UsageError naming what is wrong with `request`.
  explicit Solver(PlanRequest request);

  /// Makes room for problems of this size, unless there is. Allocates.
  void prepare(const planner::SearchProblem& problem);
  /// prepare(), then the best plan by the deadline, or by when `is_cancelled` says so (see
  /// Deadline::unless). The reference is good until the next call.
  /// @throws UsageError when `problem` breaks a rule of planner::require_valid.
  const PlanOutcome& solve(const planner::SearchProblem& problem, bool (*is_cancelled)() = nullptr);

  [[nodiscard]] const PlanRequest& request() const { return request_; }

 private:
  PlanRequest request_;
  const planner::Algorithm* algorithm_ = nullptr;
  planner::SearchCapacity capacity_;
  std::unique_ptr<planner::Search> search_;
  PlanOutcome outcome_;
};

}  // namespace vantage::tools
