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
  kAnytime,     ///< ARVI: ε = δ = ∞ first, then the schedule, at last ε = δ = 0
  kSinglePass,  ///< RVI with the given ε and δ
  kGreedy,      ///< the first pass of ARVI alone: the best next step, T times
  kExhaustive,  ///< FVI: nothing is pruned
};

struct ReducedOptions {
  ReducedSearch search = ReducedSearch::kAnytime;
  double epsilon = 1.0;  ///< of the first finite pass (kAnytime) or the only one
  double delta_m = 1.0;
  int halvings = 12;  ///< finite passes, each with half the last ε and δ, before (0, 0)
  double yaw_weight_m_per_rad = 0.3;
};

/// Forward, reduced and anytime reduced value iteration over one persistent tree.
///
/// S, O and C of the dissertation persist between passes: no child is ever computed twice. Nodes
/// of a depth are considered by ascending accumulated cost J; a node is left out of O when some
/// opened node with J' ≤ J lies within δ and ε-dominates it (single-node test: sound). At δ = 0 the
/// two have the same position and heading, whatever the yaw weight is. The leaves are never pruned:
/// the best one that can stop safely is the plan.
///
/// Guarantees: a plan exists as soon as one depth-T node has been generated; its cost never rises;
/// a finished pass at (ε, δ) obeys the bound (6.1); with ε = δ = 0 finished, it is optimal.
/// Interruptible at each node; stops at the same node under Deadline::nodes(work_nodes).
/// Allocates nothing in plan() while the problem fits the capacity.
/// Source: dissertation Alg. 1 and 2, Thm 3; Vasquez et al. / Atanasov et al. for RVI.
class ReducedValueIteration : private TreeSearch {
 public:
  explicit ReducedValueIteration(const SearchCapacity& capacity);

  /// Takes all the memory that was reserved, so that no page fault comes in plan(): for real time.
  void prefault();

  /// The best plan found by the deadline. The reference is good until the next call.
  /// @throws UsageError when `problem` breaks a rule of require_valid or exceeds the capacity.
  const SearchResult& plan(const SearchProblem& problem, const ReducedOptions& options,
                           const Deadline& deadline);

  /// What the last plan() returned.
  [[nodiscard]] const SearchResult& result() const { return result_; }
  /// Everything the last search computed, for pictures and tests.
  [[nodiscard]] const Tree& tree() const { return tree_; }

 private:
  struct Level {
    NodeList pending;             ///< considered before and left out, by ascending cost
    NodeList open;                ///< O_t
    NodeId unexpanded = kNoNode;  ///< first member of `open` that is not of C_t
  };
  enum class Progress { kDone, kDeadline, kMemory };

  Progress improve_path(double epsilon, double delta_m, bool prune);
  /// Generates the children of depth t of all nodes opened since: into O_t at once when nothing
  /// is to be pruned, into fresh_ otherwise.
  Progress expand_level(int t, bool prune);
  Progress open_level(int t, double epsilon, double delta_m);
  /// True when an opened node makes `id` superfluous; kDeadline or kMemory end the search.
  Progress is_pruned(NodeId id, double epsilon, double delta_m, const Level& level, bool& pruned);
  void offer_leaf(NodeId id);
  /// When no depth-T node can stop safely: stop as late as is safe, and hover.
  void fall_back_to_hover();
  void open_node(Level& level, NodeId id);
  /// The cheaper of what was left out and what is new; kNoNode when neither is left.
  NodeId pop_least(Level& level);

  RootBound root_bound_;
  CrossingIndex index_;
  std::vector<Level> levels_;
  CostOrder fresh_;  ///< generated and not yet considered: of one depth at a time
  std::size_t fresh_peak_ = 0;
  std::size_t index_peak_ = 0;
  PoseMetric metric_;
  NodeId best_leaf_ = kNoNode;
};

}  // namespace vantage::planner
