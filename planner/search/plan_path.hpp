#pragma once

#include <limits>

#include "planner/problem/problem.hpp"
#include "planner/search/expander.hpp"
#include "planner/search/tree.hpp"

namespace vantage::planner {

/// Selector of the cheapest node at which a robot can stop and hover for the rest of the horizon.
/// This is the plan of a search that finds no complete sequence. All offered nodes have the same
/// depth; allocates nothing.
class HoverChoice {
 public:
  HoverChoice(Expander& expander, Tree& tree) : expander_(expander), tree_(tree) {}

  /// Chooses `id` if stopping at it is safe and cheaper than at earlier offers. The parent of `id`
  /// must have been expanded. Costs one update per remaining step.
  void offer(NodeId id);

  /// Returns the chosen node; kNoNode if no offered node is suitable.
  [[nodiscard]] NodeId best() const { return best_; }
  [[nodiscard]] double cost() const { return cost_; }  ///< +∞ if there is none

 private:
  Expander& expander_;
  Tree& tree_;
  NodeId best_ = kNoNode;
  double cost_ = std::numeric_limits<double>::infinity();
};

/// Writes the path from the root to `last` into `result`, followed by a hover until
/// `horizon_steps`; does not change the cost. Allocates nothing while the horizon fits the reserved
/// size. O(horizon_steps).
void write_path(const Tree& tree, NodeId last, int horizon_steps, SearchResult& result);

/// As above, with one more control that leads from `parent` to `leaf` at the horizon's end.
void write_path(const Tree& tree, NodeId parent, int control, const Pose2& leaf,
                SearchResult& result);

}  // namespace vantage::planner
