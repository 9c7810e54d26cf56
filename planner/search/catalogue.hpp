#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/deadline.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/arvi.hpp"
#include "planner/search/baseline.hpp"

namespace vantage::planner {

/// Options of a search in addition to its problem; each algorithm uses those that it supports.
struct AlgorithmOptions {
  double epsilon = 1.0;
  double delta_m = 1.0;
  double yaw_weight_m_per_rad = 0.3;
  double weight = 1.0;  ///< weight of the heuristic
  SweepShare sweep;
};

/// One robot's search with its memory. plan() allocates nothing if the documentation of the
/// algorithm states this.
class Search {
 public:
  Search() = default;
  virtual ~Search() = default;
  Search(const Search&) = delete;
  Search& operator=(const Search&) = delete;
  Search(Search&&) = delete;
  Search& operator=(Search&&) = delete;
  /// Returns the best plan found by the deadline. The reference is valid until the next call.
  /// @throws UsageError when `problem` breaks a rule of require_valid or exceeds the capacity.
  virtual const SearchResult& plan(const SearchProblem& problem, const Deadline& deadline) = 0;
  /// Commits the first MiB of each array: plan() causes no page fault there. Use in real time.
  virtual void prefault() {}
  /// Returns the peak memory of the last search in nodes, blocks and lists, bytes.
  [[nodiscard]] virtual std::size_t peak_bytes() const = 0;
};

/// One entry of the table of algorithms.
struct Algorithm {
  std::string_view name;
  std::string_view what;  ///< description for --help, one line
  double kept_share;      ///< maximum share of the generated nodes kept in memory
  bool is_stateful;       ///< keeps state between plans, so each robot needs its own search
  bool makes_candidates;  ///< its tree yields many trajectories for a team decision
  std::function<std::unique_ptr<Search>(const SearchCapacity&, const AlgorithmOptions&)> make;
};

/// Returns all algorithms, whether robots, `vantage plan` or the planner study use them. To add a
/// search, add it in catalogue.cpp and its name in scenario::kSearchNames.
const std::vector<Algorithm>& all_algorithms();
/// Adds a search from outside the library. Scenarios, trials, `vantage plan` and Python of this
/// process can then name it. Call it before the first use of the name; not thread-safe.
/// @throws UsageError if the name is empty or already in use
void add_algorithm(Algorithm algorithm);
/// Returns the algorithm `name`. @throws UsageError with all names when it is unknown.
const Algorithm& algorithm_called(std::string_view name);
/// Returns the best algorithm for problems of the kind of `problem`: "astar" for range-only mapping
/// of static targets, where its sequencing bound quickly proves the optimum; otherwise "beam".
std::string_view default_algorithm(const SearchProblem& problem);

/// Returns the capacity that `algorithm` needs for `problem` if it generates at most `nodes_max`
/// nodes, limited to about `memory_bytes`.
SearchCapacity capacity_for(const Algorithm& algorithm, const SearchProblem& problem,
                            std::size_t memory_bytes, std::size_t nodes_max);
/// Returns an upper bound of the nodes generated within the time budget, for the size of the arena.
std::size_t nodes_within(double budget_s);

}  // namespace vantage::planner
