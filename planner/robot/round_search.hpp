#pragma once

#include <cstddef>
#include <memory>

#include "core/deadline.hpp"
#include "planner/robot/round_problem.hpp"
#include "planner/robot/workspace.hpp"

namespace vantage::planner {

/// A robot's search, by what the scenario's planner.objective wants to know more of: targets, or
/// the map.
class RoundSearch {
 public:
  RoundSearch() = default;
  virtual ~RoundSearch() = default;
  RoundSearch(const RoundSearch&) = delete;
  RoundSearch& operator=(const RoundSearch&) = delete;
  RoundSearch(RoundSearch&&) = delete;
  RoundSearch& operator=(RoundSearch&&) = delete;

  /// What a search has found; good until the next one.
  struct Found {
    const SearchResult& result;
    bool is_boxed_in = false;  ///< from here, so turned, no motion can begin
  };
  virtual Found plan(const RoundProblem& round, const Deadline& deadline) = 0;

  /// Information that `found`, of the last plan(), of `round`, gains, nats; ≥ 0.
  [[nodiscard]] virtual double gain_nats(const RoundProblem& round, const Found& found) const = 0;
};

/// `workspace` must outlive it.
std::unique_ptr<RoundSearch> make_round_search(Workspace& workspace, std::size_t robot);

}  // namespace vantage::planner
