#pragma once

#include "planner/search/tree.hpp"

namespace vantage::planner {

/// Queue of nodes linked by Node::next: any number of queues share one arena and need no separate
/// memory. A node is in one queue at a time.
struct NodeList {
  NodeId first = kNoNode;
  NodeId last = kNoNode;

  [[nodiscard]] bool is_empty() const { return first == kNoNode; }
  void push(Tree& tree, NodeId id) {
    tree[id].next = kNoNode;
    if (is_empty()) {
      first = id;
    } else {
      tree[last].next = id;
    }
    last = id;
  }
  /// Precondition: !is_empty().
  NodeId pop(const Tree& tree) {
    const NodeId id = first;
    first = tree[id].next;
    return id;
  }
};

}  // namespace vantage::planner
