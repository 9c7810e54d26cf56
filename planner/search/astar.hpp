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
#include "planner/search/tree_search.hpp"

namespace vantage::planner {

enum class BestFirst {
  kAStar,          ///< least g + h first, until no open node can be better
  kWeightedAStar,  ///< least g' + w h' first, until the plan is within w of the optimum
  kAegis,  ///< least g' + w h' first, (ε, δ)-dominated nodes left out, until OPEN is empty
};

enum class NodeBound {
  kReach,     ///< Thm 6
  kSequence,  ///< the larger of Thm 6 and the sequencing bound
};

struct BestFirstOptions {
  BestFirst search = BestFirst::kAStar;
  NodeBound bound = NodeBound::kSequence;
  double weight = 1.0;   ///< w ≥ 1, of kWeightedAStar and kAegis
  double epsilon = 0.0;  ///< of kAegis
  double delta_m = 0.0;
  double yaw_weight_m_per_rad = 0.3;
  /// Every so many expansions the search runs down to a leaf, child after best child, so that its
  /// plan improves on the way; 0: at the start alone.
  int dive_every = 64;
};

/// A*, weighted A* and AEGIS over the tree, nodes and expansion that all searches share.
///
/// The first thing is a run down to a leaf, so that there is a plan; then the least open node is
/// expanded, again and again. A node gets its own h only when it is first taken up: until then it
/// stands at its parent's f, which is no more (h is consistent). A node whose g + h is not below
/// the best plan's cost is dropped.
///
/// The certificate is plain: lower_bound = min(cost, least g + h over OPEN and over all that AEGIS
/// left out as dominated). Left out with ε = δ = 0, a node has an equal or better twin and counts
/// for nothing, so AEGIS(0, 0) ends at the optimum with gap 0 as A* does. A node is compared with
/// those already expanded (the CLOSED of Alg. 4): in OPEN none can be better before its turn.
///
/// Weights need costs ≥ 0, and log det is negative: so w multiplies h' = h − Σ_{k>t} L_k and g' is
/// g − Σ_{k≤t} L_k, where L_k is the least that the stage of depth k can cost on any plan
/// (InformationHeuristic::stage_floor). Weighted A* thus guarantees
/// J − L ≤ w (J* − L), with L = Σ_k L_k the heuristic of the root.
///
/// Interruptible at each node; stops at the same node under Deadline::nodes(work_nodes). Allocates
/// nothing in plan() while the problem fits the capacity.
/// Source: dissertation Alg. 3, 4, Thm 6, Cor. 7.
class BestFirstSearch : private TreeSearch {
 public:
  explicit BestFirstSearch(const SearchCapacity& capacity);

  /// Takes all the memory that was reserved, so that no page fault comes in plan(): for real time.
  void prefault();

  /// The best plan found by the deadline. The reference is good until the next call.
  /// @throws UsageError when `problem` breaks a rule of require_valid or exceeds the capacity.
  const SearchResult& plan(const SearchProblem& problem, const BestFirstOptions& options,
                           const Deadline& deadline);

  /// Everything the last search computed, for pictures and tests.
  [[nodiscard]] const Tree& tree() const { return tree_; }

 private:
  enum class Progress { kGoOn, kDone, kDeadline, kMemory };
  struct Entry {
    double key = 0.0;
    NodeId id = kNoNode;
  };

  void start(const SearchProblem& problem, const BestFirstOptions& options);
  Progress step();
  /// Gives `id` its own h by Thm 6. False when the arena is full.
  bool evaluate(NodeId id);
  /// Raises it by the sequencing bound.
  Progress evaluate_sequence(NodeId id);
  Progress is_dominated(NodeId id, bool& dominated);
  Progress expand(NodeId id);
  /// Evaluates new nodes and keeps back the best as next_.
  Progress choose_next(NodeId first, NodeId end);
  void offer_leaf(NodeId parent, int child);
  void push(NodeId id);
  NodeId pop();
  void clean_floors();
  [[nodiscard]] double key(NodeId id) const;
  [[nodiscard]] double least_open() const;
  /// When no depth-T node can stop safely: stop as late as is safe, and hover.
  void fall_back_to_hover();

  InformationHeuristic heuristic_;
  SequencingBound sequencing_;
  CrossingIndex index_;
  std::vector<float> child_f_;  ///< of the children to be of nodes with a sequence, rounded down
  ReservedArray<std::uint32_t> child_f_at_;  ///< per node: where, 0: nowhere
  ReservedArray<double> f_;                  ///< per node: lower bound of every plan through it
  std::vector<Entry> open_;                  ///< a heap, least key first
  std::vector<Entry> floors_;                ///< w > 1: a heap of plain f, with entries out of date
  std::size_t open_peak_ = 0;
  std::size_t floors_peak_ = 0;
  std::vector<double> floor_sums_;  ///< Σ_{k ≤ t} L_k
  std::vector<NodeId> stops_;       ///< the first nodes of each depth, to fall back to
  std::vector<int> stop_counts_;
  PoseMetric metric_;
  BestFirstOptions options_;
  bool weighted_ = false;
  NodeId next_ = kNoNode;  ///< of the run down to a leaf; open, though not in open_
  bool dives_ = false;
  std::int64_t next_dive_ = 0;
  double least_dominated_ = 0.0;
  NodeId best_parent_ = kNoNode;  ///< of the best leaf
  int best_control_ = -1;
  Pose2 best_pose_;
};

}  // namespace vantage::planner
