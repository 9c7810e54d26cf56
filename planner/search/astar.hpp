#pragma once

#include <cstdint>
#include <vector>

#include "core/deadline.hpp"
#include "core/reserved_array.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/arvi.hpp"
#include "planner/search/crossing_index.hpp"
#include "planner/search/heuristic.hpp"
#include "planner/search/sequencing_bound.hpp"
#include "planner/search/terminal_bound.hpp"
#include "planner/search/tree_search.hpp"

namespace vantage::planner {

enum class BestFirst {
  kAStar,  ///< expands the node of least g + h first, until no open node can improve the plan
  /// expands the node of least g' + w h' first, until the plan is within factor w of the optimum
  kWeightedAStar,
  kAegis,  ///< as kWeightedAStar, but discards (ε, δ)-dominated nodes and continues until OPEN is
           ///< empty
};

enum class NodeBound {
  kReach,     ///< the bound of Thm 6
  kSequence,  ///< the larger of Thm 6 and the sequencing bound
};

struct BestFirstOptions {
  BestFirst search = BestFirst::kAStar;
  NodeBound bound = NodeBound::kSequence;
  double weight = 1.0;   ///< w ≥ 1, for kWeightedAStar and kAegis
  double epsilon = 0.0;  ///< ε of kAegis
  double delta_m = 0.0;
  double yaw_weight_m_per_rad = 0.3;
  /// Number of expansions between two dives. A dive follows the best child down to a leaf, so that
  /// the plan improves early. 0: one dive at the start.
  int dive_every = 64;
};

/// A*, weighted A* and AEGIS, on the common tree and node expansion.
///
/// The search starts with a dive to a leaf, so that a plan exists, and then repeatedly expands the
/// least open node. The h of a node is computed when the node is first selected. Until then the
/// node uses its parent's f, which is not larger (h is consistent). A node is dropped if its g + h
/// is not below the best plan's cost.
///
/// The certificate is unweighted: lower_bound = min(cost, least g + h over OPEN and over all nodes
/// that AEGIS discarded as dominated). A node discarded with ε = δ = 0 does not count, because an
/// equal or better node exists at the same pose. So AEGIS(0, 0) ends at the optimum with gap 0,
/// like A*. A node is compared with expanded nodes (the CLOSED of Alg. 4): no node in OPEN can be
/// better before it is selected.
///
/// Weights require costs ≥ 0, but log det can be negative. The weight w therefore multiplies h' = h
/// − Σ_{k>t} L_k, and g' is g − Σ_{k≤t} L_k, where L_k is the least possible cost of the stage at
/// depth k (InformationHeuristic::stage_floor). Weighted A* thus guarantees J − L ≤ w (J* − L),
/// where L = Σ_k L_k is the heuristic of the root.
///
/// The search can be interrupted at each node. With Deadline::nodes(work_nodes) it stops at the
/// same node again. plan() allocates nothing while the problem fits the capacity.
/// Source: dissertation Alg. 3, 4, Thm 6, Cor. 7.
class BestFirstSearch : private TreeSearch {
 public:
  explicit BestFirstSearch(const SearchCapacity& capacity);

  /// Commits the first MiB of each array: plan() causes no page fault there. Use in real time.
  void prefault();

  /// Returns the best plan found by the deadline. The reference is valid until the next call.
  /// @throws UsageError when `problem` breaks a rule of require_valid or exceeds the capacity.
  const SearchResult& plan(const SearchProblem& problem, const BestFirstOptions& options,
                           const Deadline& deadline);

  /// Returns the tree of the last search, for plots and tests.
  [[nodiscard]] const Tree& tree() const { return tree_; }

 private:
  enum class Progress { kGoOn, kDone, kDeadline, kMemory };
  struct Entry {
    double key = 0.0;
    NodeId id = kNoNode;
  };

  void start(const SearchProblem& problem, const BestFirstOptions& options);
  Progress step();
  /// Computes h of `id` by Thm 6. False if the arena is full.
  bool evaluate(NodeId id);
  /// Raises h of `id` to the sequencing bound, if this bound is larger.
  Progress evaluate_sequence(NodeId id);
  Progress is_dominated(NodeId id, bool& dominated);
  Progress expand(NodeId id);
  /// Evaluates the new nodes [first, end) and sets next_ to the best.
  Progress choose_next(NodeId first, NodeId end);
  void offer_leaf(NodeId parent, int child);
  void push(NodeId id);
  NodeId pop();
  void clean_floors();
  [[nodiscard]] double key(NodeId id) const;
  [[nodiscard]] double least_open() const;
  /// Sets the plan if no depth-T node can stop safely: stop at the deepest safe node and hover.
  void fall_back_to_hover();

  InformationHeuristic heuristic_;
  SequencingBound sequencing_;
  TerminalBound terminal_;
  CrossingIndex index_;
  std::vector<float> child_f_;               ///< f of children that do not exist yet, rounded down
  ReservedArray<std::uint32_t> child_f_at_;  ///< per node: index into child_f_; 0: none
  ReservedArray<double> f_;                  ///< per node: lower bound of every plan through it
  std::vector<Entry> open_;                  ///< a heap, least key first
  std::vector<Entry> floors_;  ///< for w > 1: a heap of unweighted f; some entries may be outdated
  std::size_t open_peak_ = 0;
  std::size_t floors_peak_ = 0;
  std::vector<double> floor_sums_;  ///< Σ_{k ≤ t} L_k
  std::vector<NodeId>
      stops_;  ///< first nodes of each depth, from which the fallback plan is chosen
  std::vector<int> stop_counts_;
  PoseMetric metric_;
  BestFirstOptions options_;
  bool weighted_ = false;
  NodeId next_ = kNoNode;  ///< next node of the dive; it is an open node but is not stored in open_
  bool dives_ = false;
  std::int64_t next_dive_ = 0;
  double least_dominated_ = 0.0;
  NodeId best_parent_ = kNoNode;  ///< parent of the best leaf
  int best_control_ = -1;
  Pose2 best_pose_;
};

}  // namespace vantage::planner
