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

namespace vantage::tools {

/// What a search may be told besides its problem; each algorithm uses those that it knows.
struct AlgorithmOptions {
  double epsilon = 1.0;
  double delta_m = 1.0;
  double weight = 1.0;  ///< of the heuristic
  std::uint64_t seed = 0;
};

/// A search object, its arena prepared: search() allocates nothing.
class Search {
 public:
  virtual ~Search() = default;
  virtual const planner::SearchResult& search(const planner::SearchProblem& problem,
                                              const Deadline& deadline) = 0;
  /// Bytes that the last search had in use at its peak, of nodes, blocks and lists.
  [[nodiscard]] virtual std::size_t peak_bytes() const = 0;
};

/// One entry of the table of algorithms.
struct Algorithm {
  std::string_view name;
  std::string_view what;  ///< one line for --help
  double kept_share;      ///< of the nodes that it generates, at most
  std::function<std::unique_ptr<Search>(const planner::SearchCapacity&, const AlgorithmOptions&)>
      make;
};

/// Every algorithm that `vantage plan` and the planner study offer. A new search is added here and
/// nowhere else.
const std::vector<Algorithm>& all_algorithms();
/// The one called `name`. Precondition: it is in the table.
const Algorithm& algorithm_called(std::string_view name);
/// The one that does best on problems of this family: "astar" for range-only mapping of what stands
/// still, where its sequencing bound soon proves the optimum; else "beam".
std::string_view default_algorithm(const planner::SearchProblem& problem);

/// The capacity that `algorithm` needs for `problem`, in about `memory_bytes` at most, when it
/// generates no more than `nodes_max` nodes.
planner::SearchCapacity capacity_for(const Algorithm& algorithm,
                                     const planner::SearchProblem& problem,
                                     std::size_t memory_bytes, std::size_t nodes_max);
/// Nodes that no search can exceed within the budget: what sizes the arena.
std::size_t nodes_within(double budget_s);

}  // namespace vantage::tools
