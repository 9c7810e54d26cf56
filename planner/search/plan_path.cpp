#include "planner/search/plan_path.hpp"

#include <algorithm>

namespace vantage::planner {

void HoverChoice::offer(NodeId id) {
  const Node& node = tree_[id];
  const MotionTable& motion = expander_.motion();
  const bool stops = node.depth == 0
                         ? motion.can_stop_from_start()
                         : motion.can_stop(node.world_from_body, node.control, node.depth);
  if (!stops || !expander_.ensure_posterior(tree_, id)) {
    return;
  }
  const double cost = expander_.cost_of_hovering(tree_, id);
  if (cost < cost_) {
    cost_ = cost;
    best_ = id;
  }
}

void write_path(const Tree& tree, NodeId last, int horizon_steps, SearchResult& result) {
  result.found = true;
  result.controls.clear();
  result.poses.clear();
  result.moving_steps = tree[last].depth;
  for (NodeId id = last; tree[id].parent != kNoNode; id = tree[id].parent) {
    result.controls.push_back(tree[id].control);
    result.poses.push_back(tree[id].world_from_body);
  }
  std::reverse(result.controls.begin(), result.controls.end());
  std::reverse(result.poses.begin(), result.poses.end());
  result.poses.resize(static_cast<std::size_t>(horizon_steps), tree[last].world_from_body);
}

void write_path(const Tree& tree, NodeId parent, int control, const Pose2& leaf,
                SearchResult& result) {
  const int steps = tree[parent].depth + 1;
  write_path(tree, parent, steps, result);
  result.controls.push_back(control);
  result.poses.back() = leaf;
  result.moving_steps = steps;
}

}  // namespace vantage::planner
