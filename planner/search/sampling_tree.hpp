#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "core/deadline.hpp"
#include "core/reserved_array.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/crossing_index.hpp"
#include "planner/search/heuristic.hpp"
#include "planner/search/root_bound.hpp"
#include "planner/search/sighting_value.hpp"
#include "planner/search/terminal_bound.hpp"
#include "planner/search/tree_search.hpp"

namespace vantage::planner {

/// Options of a sampling tree. ε and δ are those of the first sweep.
struct SamplingTreeOptions {
  double epsilon = 1.0;
  double delta_m = 1.0;
  double yaw_weight_m_per_rad = 0.3;
  double greed = 0.6;         ///< share of the steps that take the most promising child
  double wander = 0.1;        ///< share of the steps that take a child drawn uniformly
  double breadth = 0.2;       ///< share of the branches that begin at a node drawn uniformly
  double near_targets = 0.5;  ///< share of the goals drawn near targets instead of in reach
  double persistence = 0.5;   ///< share of a depth's information gain expected to last
  double anticipation = 0.3;  ///< share of a first sighting's expected value credited in advance
};

/// Informed tree that grows by random branches, for long horizons and many controls.
///
/// A branch begins at a drawn node of a drawn depth, usually the cheapest of a few. It has a goal,
/// a position drawn continuously from the reachable disc or near a target. Each step takes the
/// child nearest to the goal, the most promising child or a drawn child, until the horizon. Motions
/// are checked exactly over the whole area that the vehicle covers (MotionTable).
///
/// Pruning: a child is removed permanently if its cost plus the bound of Theorem 6 is at least the
/// cost of the best plan. A child is also rejected if another node of its depth within δ has no
/// larger cost and ε-dominates it, by the test of reduced value iteration. ε and δ are halved from
/// sweep to sweep and finally 0; each sweep does twice the work of the one before. A rejected child
/// can be drawn again in a later sweep. Every remaining node and control has a positive probability
/// in each branch. So the cost converges to the optimum over the controls with probability 1 if the
/// memory suffices, and if the tree is complete, the plan is proven optimal (kFinished).
///
/// Deterministic: random numbers come from the problem's seed. The search can be interrupted at
/// each node; Deadline::nodes(work_nodes) stops it at the same node again. plan() allocates nothing
/// while the problem fits the capacity. Source: Hollinger and Sukhatme, IJRR 2014 (RIG-tree);
/// Li, Littlefield and Bekris, IJRR 2016 (SST, drawn controls); the bound and the sweeps are ours.
class SamplingTree : private TreeSearch {
 public:
  explicit SamplingTree(const SearchCapacity& capacity);

  /// Commits the reserved arrays, so that plan() causes no page fault in them. Needed in real time.
  void prefault();

  /// Returns the best plan found by the deadline. The reference is valid until the next call.
  /// @throws UsageError when `problem` breaks a rule of require_valid or exceeds the capacity.
  const SearchResult& plan(const SearchProblem& problem, const SamplingTreeOptions& options,
                           const Deadline& deadline);

 private:
  enum class Progress { kDone, kDeadline, kMemory };
  enum State : std::uint8_t { kNew = 0, kRejected = 1, kExpanded = 2, kComplete = 3 };
  /// Growth of a node.
  struct Growth {
    NodeId first_child = kNoNode;    ///< the children are linked by Node::next
    std::uint64_t closed = 0;        ///< controls that need not be drawn again
    std::uint64_t rejected = 0;      ///< controls of children rejected in `rejected_epoch`
    std::int32_t controls_left = 0;  ///< feasible controls that are not closed
    NodeId next_in_cell = kNoNode;
    std::uint32_t cell_epoch = 0;  ///< sweep that entered the node into its cell
    std::uint32_t rejected_epoch = 0;
  };

  void begin_sweep();
  /// Grows one branch from a drawn node.
  Progress grow_branch();
  [[nodiscard]] NodeId draw_start();
  [[nodiscard]] Eigen::Vector2d draw_goal();
  /// Returns the index in children_ of the next step, or −1 if every control is closed.
  int choose_child(NodeId id, const Eigen::Vector2d& goal_m);
  /// Computes children_ of `id` and closes those that the bound excludes. Leaves are offered as
  /// plans.
  Progress expand(NodeId id);
  /// Enters child i of `id`, and adds it to the tree if it is new. Sets `child` to kNoNode if the
  /// child was rejected.
  Progress enter_child(NodeId id, int i, NodeId& child);
  /// Marks `id` and then its ancestors as complete, as long as all of their controls are closed.
  void complete(NodeId id);
  /// Sets `is_rejected` if a node of the same depth makes `id` redundant.
  Progress reject(NodeId id, bool& is_rejected);
  void close(NodeId id, int control);
  [[nodiscard]] NodeId child_by(NodeId id, int control) const;
  [[nodiscard]] std::size_t bucket(const Pose2& pose, int depth, int dx, int dy) const;
  [[nodiscard]] double draw(double low, double high);
  [[nodiscard]] std::uint32_t draw_below(std::size_t count);
  void fall_back_to_hover();
  /// Counts one unit of work; true if the search has to stop.
  bool work() {
    ++result_.work_nodes;
    return expired();
  }

  RootBound root_bound_;
  InformationHeuristic heuristic_;
  TerminalBound terminal_;
  SightingValue sighting_;
  std::mt19937_64 random_;
  ReservedArray<Growth> growths_;  ///< per node
  ReservedArray<NodeId> cells_;    ///< hash table of the nodes by depth and position
  ReservedArray<std::uint32_t> epochs_;
  std::uint32_t epoch_ = 0;
  std::vector<double> floors_;  ///< [depth]: least cost of the later steps
  const SamplingTreeOptions* options_ = nullptr;
  PoseMetric metric_;
  double epsilon_ = 0.0;
  double delta_m_ = 0.0;
  int sweep_ = 0;
  std::int64_t branches_ = 0;
  std::int64_t sweep_end_nodes_ = 0;
};

}  // namespace vantage::planner
