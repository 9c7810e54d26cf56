#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "planner/problem/problem.hpp"
#include "planner/search/catalogue.hpp"

namespace vantage::tools {

inline constexpr double kLongestBudget_s = 86'400.0;

/// Options for solving a planning problem.
struct PlanRequest {
  std::string algorithm =
      "default";  ///< name in planner::all_algorithms(), or "default": chosen for the problem
  double budget_s = 1.0;              ///< s; time limit of the search alone
  std::optional<std::int64_t> nodes;  ///< replaces budget_s by a node limit: reproducible
  planner::AlgorithmOptions options;
  std::size_t memory_mb = 512;  ///< MiB; maximum memory of the search
};

/// Result of one search with its cost.
struct PlanOutcome {
  std::string source;  ///< file of the problem; set by the caller
  std::string algorithm;
  planner::SearchResult result;
  double elapsed_s = 0.0;       ///< s; wall-clock time of the search alone
  double cpu_s = 0.0;           ///< s; processor time of the search thread during elapsed_s
  std::size_t peak_bytes = 0;   ///< bytes; maximum size of nodes, blocks and lists in use
  bool is_interrupted = false;  ///< cancelled by the user before the budget was spent
};

/// Solver of planning problems for `vantage plan` and Python. It reuses its memory for several
/// problems. Not thread-safe.
class Solver {
 public:
  /// @throws UsageError if a value of `request` is invalid.
  explicit Solver(PlanRequest request);

  /// Allocates memory for problems of this size unless there is enough.
  void prepare(const planner::SearchProblem& problem);
  /// Calls prepare() and returns the best plan found until the deadline or until `is_cancelled`
  /// returns true (see Deadline::unless). The reference is valid until the next call.
  /// @throws UsageError if `problem` violates a rule of planner::require_valid.
  const PlanOutcome& solve(const planner::SearchProblem& problem, bool (*is_cancelled)() = nullptr);

 private:
  PlanRequest request_;
  const planner::Algorithm* algorithm_ = nullptr;
  planner::SearchCapacity capacity_;
  std::unique_ptr<planner::Search> search_;
  PlanOutcome outcome_;
};

}  // namespace vantage::tools
