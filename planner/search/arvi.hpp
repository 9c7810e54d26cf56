#pragma once

#include <cstdint>
#include <vector>

#include "core/deadline.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/cost_order.hpp"
#include "planner/search/crossing_index.hpp"
#include "planner/search/node_list.hpp"
#include "planner/search/root_bound.hpp"
#include "planner/search/tree_search.hpp"

namespace vantage::planner {

enum class ReducedSearch {
  kAnytime,  ///< ARVI: a pass with ε = δ = ∞, then passes with halved values, finally ε = δ = 0
  kSinglePass,  ///< RVI with the given ε and δ
  kGreedy,      ///< first pass of ARVI only: the best next step, T times
  kExhaustive,  ///< FVI: no pruning
};

struct ReducedOptions {
  ReducedSearch search = ReducedSearch::kAnytime;
  double epsilon = 1.0;  ///< ε of the first finite pass (kAnytime) or the single pass
  double delta_m = 1.0;
  int halvings = 12;  ///< number of finite passes before (0, 0); each halves ε and δ
  double yaw_weight_m_per_rad = 0.3;
  /// Stores all nodes of depth T in tree(), not only the best one: for candidates and plots.
  bool keeps_leaves = false;
};

/// Forward, reduced and anytime reduced value iteration (FVI, RVI, ARVI) over one persistent tree.
///
/// The node sets S, O and C of the dissertation persist between passes, so each child is computed
/// once. The nodes of a depth are considered by ascending accumulated cost J. A node is excluded
/// from O if an opened node with J' ≤ J lies within δ and ε-dominates the node. This test compares
/// single nodes, which is safe. At δ = 0 both nodes must have the same position and heading,
/// independent of the yaw weight. Leaves are never pruned: the best leaf that can stop safely is
/// the plan.
///
/// Guarantees: a plan exists as soon as one depth-T node has been generated; its cost never
/// increases; a completed pass at (ε, δ) satisfies the bound (6.1) of the dissertation; a completed
/// pass at ε = δ = 0 is optimal. The search can be interrupted at each node. With
/// Deadline::nodes(work_nodes) it stops at the same node again. plan() allocates nothing while the
/// problem fits the capacity.
/// Source: dissertation Alg. 1 and 2, Thm 3; Vasquez et al. / Atanasov et al. for RVI.
class ReducedValueIteration : private TreeSearch {
 public:
  explicit ReducedValueIteration(const SearchCapacity& capacity);

  /// Commits the first MiB of each array: plan() causes no page fault there. Use in real time.
  void prefault();

  /// Returns the best plan found by the deadline. The reference is valid until the next call.
  /// @throws UsageError when `problem` breaks a rule of require_valid or exceeds the capacity.
  const SearchResult& plan(const SearchProblem& problem, const ReducedOptions& options,
                           const Deadline& deadline);

  /// Returns the result of the last plan().
  [[nodiscard]] const SearchResult& result() const { return result_; }
  /// Returns the tree of the last search, for plots and tests.
  [[nodiscard]] const Tree& tree() const { return tree_; }

 private:
  struct Level {
    NodeList pending;             ///< nodes excluded in earlier passes, by ascending cost
    NodeList open;                ///< O_t, the open nodes
    NodeId unexpanded = kNoNode;  ///< index of the first member of `open` that is not in C_t
  };
  enum class Progress { kDone, kDeadline, kMemory };

  Progress improve_path(double epsilon, double delta_m, bool prune);
  /// Generates the depth-t children of all nodes opened since the last call. Stores them in O_t if
  /// nothing is pruned, otherwise in fresh_.
  Progress expand_level(int t, bool prune);
  Progress open_level(int t, double epsilon, double delta_m);
  /// Sets `pruned` if an opened node makes `id` redundant; kDeadline or kMemory end the search.
  Progress is_pruned(NodeId id, double epsilon, double delta_m, const Level& level, bool& pruned);
  [[nodiscard]] bool is_best_leaf(int i) const {
    return best_leaf_ == kNoNode || children_.cost[i] < result_.cost;
  }
  /// Makes child `i` of `parent`, of depth T, the plan if it is the best so far and can stop
  /// safely. False if the arena is full.
  bool offer_leaf(int i, NodeId parent);
  /// Sets the plan if no depth-T node can stop safely: stop at the deepest safe node and hover.
  void fall_back_to_hover();
  void open_node(Level& level, NodeId id);
  /// Removes and returns the cheapest of the pending and the new nodes; kNoNode if none is left.
  NodeId pop_least(Level& level);

  RootBound root_bound_;
  CrossingIndex index_;
  std::vector<Level> levels_;
  CostOrder fresh_;  ///< nodes of one depth, generated but not yet considered
  std::size_t fresh_peak_ = 0;
  std::size_t index_peak_ = 0;
  PoseMetric metric_;
  NodeId best_leaf_ = kNoNode;
  bool keeps_leaves_ = false;
};

}  // namespace vantage::planner
