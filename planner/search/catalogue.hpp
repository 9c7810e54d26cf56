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

/// What a search may be told besides its problem; each algorithm uses those that it knows.
struct AlgorithmOptions {
  double epsilon = 1.0;
  double delta_m = 1.0;
  double yaw_weight_m_per_rad = 0.3;
  double weight = 1.0;  ///< of the heuristic
  SweepShare sweep;
};

/// One robot's search, its arena prepared: plan() allocates nothing where the algorithm says so.
class Search {
 public:
  Search() = default;
  virtual ~Search() = default;
  Search(const Search&) = delete;
  Search& operator=(const Search&) = delete;
  Search(Search&&) = delete;
  Search& operator=(Search&&) = delete;
  /// The best plan found by the deadline. The reference is good until the next call.
  /// @throws UsageError when `problem` breaks a rule of require_valid or exceeds the capacity.
  virtual const SearchResult& plan(const SearchProblem& problem, const Deadline& deadline) = 0;
  /// Takes all the memory that was reserved, so that no page fault comes in plan(): for real time.
  virtual void prefault() {}
  /// Bytes that the last search had in use at its peak, of nodes, blocks and lists.
  [[nodiscard]] virtual std::size_t peak_bytes() const = 0;
};

/// One entry of the table of algorithms.
struct Algorithm {
  std::string_view name;
  std::string_view what;  ///< one line for --help
  double kept_share;      ///< of the nodes that it generates, at most
  bool remembers;         ///< what it did in earlier plans: each robot has its own
  bool makes_candidates;  ///< its tree gives a team's decision many trajectories to choose from
  std::function<std::unique_ptr<Search>(const SearchCapacity&, const AlgorithmOptions&)> make;
};

/// Every algorithm: what robots fly by, `vantage plan` and the planner study offer. A new search is
/// added here; that scenarios may name it, scenario::kSearchWords says.
const std::vector<Algorithm>& all_algorithms();
/// The one called `name`. @throws UsageError with the names when it is not in the table.
const Algorithm& algorithm_called(std::string_view name);
/// The one that does best on problems of this family: "astar" for range-only mapping of what stands
/// still, where its sequencing bound soon proves the optimum; else "beam".
std::string_view default_algorithm(const SearchProblem& problem);

/// The capacity that `algorithm` needs for `problem`, in about `memory_bytes` at most, when it
/// generates no more than `nodes_max` nodes.
SearchCapacity capacity_for(const Algorithm& algorithm, const SearchProblem& problem,
                            std::size_t memory_bytes, std::size_t nodes_max);
/// Nodes that no search can exceed within the budget: what sizes the arena.
std::size_t nodes_within(double budget_s);

}  // namespace vantage::planner
