#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "planner/problem/belief_table.hpp"
#include "planner/search/expander.hpp"
#include "planner/search/tree.hpp"

namespace vantage::test {

/// Every node of a small problem, with its blocks, grown by the expander that all searches share.
struct FullTree {
  planner::Expander expander;
  planner::Tree tree;

  explicit FullTree(const planner::SearchProblem& problem)
      : expander(64, 16, 8), tree(8'000, 400'000) {
    expander.reset(problem);
    tree.add(expander.root());
    for (planner::NodeId id = 0; id < tree.node_count(); ++id) {
      const int depth = tree[id].depth;
      complete = expander.ensure_posterior(tree, id) && complete;
      planner::Children children;
      if (depth == problem.horizon_steps) {
        continue;
      }
      complete = expander.expand(tree, id, children) && complete;
      for (int i = 0; i < children.count; ++i) {
        planner::Node child;
        child.world_from_body = children.world_from_body[i];
        child.cost = children.cost[i];
        child.parent = id;
        child.control = children.control[i];
        child.depth = static_cast<std::uint8_t>(depth + 1);
        complete = tree.add(child) != planner::kNoNode && complete;
      }
    }
  }

  /// Poses of the steps that led to `id`.
  [[nodiscard]] std::vector<Pose2> path(planner::NodeId id) const {
    std::vector<Pose2> poses;
    for (; tree[id].parent != planner::kNoNode; id = tree[id].parent) {
      poses.insert(poses.begin(), tree[id].world_from_body);
    }
    return poses;
  }

  /// Covariance of target m at `id`, whether the node's own or the shared prediction.
  [[nodiscard]] models::StateMatrix covariance(planner::NodeId id, int m) const {
    const planner::Blocks blocks = tree.posterior(id);
    const planner::BeliefTable& beliefs = expander.beliefs();
    const double* block = blocks.packed;
    for (const std::uint16_t target : blocks.targets) {
      if (target == m) {
        return planner::unpack(beliefs.layout(m), block);
      }
      block += planner::packed_size(beliefs.layout(target));
    }
    return planner::unpack(beliefs.layout(m), beliefs.open_loop(m, tree[id].depth));
  }

  /// The joint covariance that no search ever forms.
  [[nodiscard]] Eigen::MatrixXd joint_covariance(planner::NodeId id) const {
    Eigen::Index rows = 0;
    for (int m = 0; m < expander.beliefs().target_count(); ++m) {
      rows += covariance(id, m).rows();
    }
    Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(rows, rows);
    Eigen::Index at = 0;
    for (int m = 0; m < expander.beliefs().target_count(); ++m) {
      const models::StateMatrix block = covariance(id, m);
      joint.block(at, at, block.rows(), block.cols()) = block;
      at += block.rows();
    }
    return joint;
  }

  /// Least cost, from the root, of a complete safe path through each node; +∞ when none leads on.
  [[nodiscard]] std::vector<double> best_through(int horizon_steps) const {
    std::vector<double> best(tree.node_count(), std::numeric_limits<double>::infinity());
    for (planner::NodeId id = static_cast<planner::NodeId>(tree.node_count()); id-- > 0;) {
      const planner::Node& node = tree[id];
      if (node.depth == horizon_steps &&
          expander.motion().can_stop(node.world_from_body, node.control, node.depth)) {
        best[id] = node.cost;
      }
      if (node.parent != planner::kNoNode) {
        best[node.parent] = std::min(best[node.parent], best[id]);
      }
    }
    return best;
  }

  bool complete = true;  ///< false: the arena was too small
};

}  // namespace vantage::test
