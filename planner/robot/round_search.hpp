#pragma once

#include <cstddef>
#include <memory>

#include "core/deadline.hpp"
#include "planner/robot/round_problem.hpp"
#include "planner/robot/workspace.hpp"

namespace vantage::planner {

/// A robot's search, for targets or for the map, as selected by planner.objective.
class RoundSearch {
 public:
  RoundSearch() = default;
  virtual ~RoundSearch() = default;
  RoundSearch(const RoundSearch&) = delete;
  RoundSearch& operator=(const RoundSearch&) = delete;
  RoundSearch(RoundSearch&&) = delete;
  RoundSearch& operator=(RoundSearch&&) = delete;

  /// Result of a search; valid until the next search.
  struct Found {
    const SearchResult& result;
    bool is_blocked = false;  ///< no motion can begin at this pose
  };
  virtual Found plan(const RoundProblem& round, const Deadline& deadline) = 0;

  /// Returns the information gain of `found` in nats (≥ 0). `found` must come from the last call of
  /// plan(round).
  [[nodiscard]] virtual double gain_nats(const RoundProblem& round, const Found& found) const = 0;
};

/// Creates the search of robot `robot` (by index). `workspace` must outlive the result.
std::unique_ptr<RoundSearch> make_round_search(Workspace& workspace, std::size_t robot);

}  // namespace vantage::planner
