#pragma once

#include <limits>

#include "planner/problem/problem.hpp"
#include "planner/search/expander.hpp"
#include "planner/search/tree.hpp"

namespace vantage::planner {

/// The cheapest node at which a robot can stop and hover for the rest of the horizon: the plan of a
/// search that finds no complete sequence. Offer it nodes of one depth; allocates nothing.
class HoverChoice {
 public:
  HoverChoice(Expander& expander, Tree& tree) : expander_(expander), tree_(tree) {}

  /// Takes `id` if stopping there is safe and cheaper than what was offered before. Its parent must
  /// have been expanded. Costs one update for each step left.
  void offer(NodeId id);

  /// kNoNode when none of the nodes offered will do.
  [[nodiscard]] NodeId best() const { return best_; }
  [[nodiscard]] double cost() const { return cost_; }  ///< +∞ without one

 private:
  Expander& expander_;
  Tree& tree_;
  NodeId best_ = kNoNode;
  double cost_ = std::numeric_limits<double>::infinity();
};

/// Writes the way from the root to `last` into `result`, hovering there until `horizon_steps`; the
/// cost is left alone. Allocates nothing while the horizon fits what is reserved. O(horizon_steps).
void write_path(const Tree& tree, NodeId last, int horizon_steps, SearchResult& result);

/// The same with one control more, which leads from `parent` to `leaf` at the horizon's end.
void write_path(const Tree& tree, NodeId parent, int control, const Pose2& leaf,
                SearchResult& result);

}  // namespace vantage::planner
