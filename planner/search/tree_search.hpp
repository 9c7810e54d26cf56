#pragma once

#include <cstddef>

#include "core/deadline.hpp"
#include "core/index.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/capacity.hpp"
#include "planner/search/expander.hpp"
#include "planner/search/plan_path.hpp"
#include "planner/search/tree.hpp"

namespace vantage::planner {

/// Common members of tree searches: arena, expander, result.
class TreeSearch {
 protected:
  /// Reserves all memory that a search writes. `passes_max`: capacity of the result's history.
  TreeSearch(const SearchCapacity& capacity, std::size_t passes_max)
      : capacity_(capacity),
        tree_(capacity.nodes_max, capacity.block_doubles_max),
        expander_(capacity.targets_max, capacity.horizon_max, capacity.teammates_max,
                  capacity.motion_steps_max) {
    result_.controls.reserve(index(capacity.horizon_max));
    result_.poses.reserve(index(capacity.horizon_max));
    result_.history.reserve(passes_max);
  }

  [[nodiscard]] bool expired() const { return deadline_->expired(result_.work_nodes); }

  /// Sets the plan if no complete sequence can stop safely: the best hover at the greatest depth
  /// below `depths` at which a hover exists. `offer(depth, choice)` offers the search's nodes of a
  /// depth. Leaves the result unchanged if there is none.
  template <class Offer>
  void hover_as_late_as_safe(int depths, const Offer& offer) {
    for (int depth = depths - 1; depth >= 0; --depth) {
      HoverChoice choice(expander_, tree_);
      offer(depth, choice);
      if (choice.best() != kNoNode) {
        result_.cost = choice.cost();
        write_path(tree_, choice.best(), problem_->horizon_steps, result_);
        return;
      }
    }
  }

  SearchCapacity capacity_;
  Tree tree_;
  Expander expander_;
  Children children_;
  const SearchProblem* problem_ = nullptr;
  const Deadline* deadline_ = nullptr;
  SearchResult result_;
};

}  // namespace vantage::planner
