#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/index.hpp"
#include "planner/problem/belief_table.hpp"
#include "planner/problem/motion_table.hpp"
#include "planner/problem/problem.hpp"
#include "planner/problem/sight.hpp"
#include "planner/search/candidate_grid.hpp"
#include "planner/search/tree.hpp"

namespace vantage::planner {

/// Poses of the children of one node, computed on request: most leaves are discarded by their cost.
struct ChildPoses {
  Views views;  ///< positions and headings
  Pose2 world_from_parent;
  const MotionTable* motion = nullptr;
  std::int16_t control[kMaxControls];

  template <class Index>
  [[nodiscard]] Pose2 operator[](Index i) const {
    return {views.x_m[i], views.y_m[i], motion->child_yaw_rad(world_from_parent, control[i])};
  }
};

/// Children of one node: the feasible controls in ascending order.
struct Children {
  int count = 0;
  std::int16_t control[kMaxControls];
  double cost[kMaxControls];           ///< accumulated J plus the terminal value at the child
  double terminal_rise[kMaxControls];  ///< terminal value at the child minus that at the parent
  ChildPoses world_from_body;

  [[nodiscard]] Node node(int i, NodeId parent, int depth) const {
    Node child;
    child.world_from_body = world_from_body[i];
    child.cost = cost[i];
    child.parent = parent;
    child.control = control[i];
    child.depth = static_cast<std::uint8_t>(depth);
    return child;
  }
};

/// Expander of nodes: computes collision-free motions, the information of every sensor about every
/// visible target, and the accumulated cost. All searches use this class; they differ in the nodes
/// that they expand and prune.
///
/// A parent is predicted once for all children. For a child, one small determinant per visible
/// target is computed; its covariances are computed only when it is expanded or compared. Allocates
/// nothing after construction.
///
/// With a terminal value V, the cost of a node at depth t ≥ 1 is J plus V at its position and the
/// targets measured before depth t. At the last depth this is the cost of the plan. Earlier it
/// ranks nodes: V replaces the unknown later steps.
class Expander {
 public:
  /// `motion_steps_max`: see SearchCapacity.
  Expander(int targets_max, int horizon_max, int teammates_max, int motion_steps_max = 0);

  /// Tabulates `problem`, which must outlive the queries. Precondition: require_valid(problem).
  void reset(const SearchProblem& problem);

  [[nodiscard]] Node root() const;

  /// Computes the children of `id` and stores the blocks of `id` in `tree`. False if the arena is
  /// full (`out` is then empty).
  bool expand(Tree& tree, NodeId id, Children& out);

  /// Computes and stores the blocks of `id` if they are missing. The parent of `id` must have been
  /// expanded.
  bool ensure_posterior(Tree& tree, NodeId id);

  /// Returns the cost of `id` plus that of staying at its pose for the remaining steps.
  /// Precondition: has_posterior(id).
  [[nodiscard]] double cost_of_hovering(const Tree& tree, NodeId id);

  /// True if every covariance block of a, plus εI, is ⪰ the block of b: b has at least as much
  /// information as a, up to ε. With a terminal value, b must also have measured every stop that a
  /// has measured, and b's J must be at most a's J plus ε. The test is conservative; see
  /// planner::dominates. Precondition: both have the same depth and posteriors, and their parents
  /// have posteriors.
  [[nodiscard]] bool is_redundant(const Tree& tree, NodeId a, double epsilon, NodeId b) const;

  /// Returns the terminal value at the position of `id`: its cost minus J, the cost of its path.
  /// Returns 0 for the root, and if costs include no terminal value. Precondition: the parent of
  /// `id` has a posterior.
  [[nodiscard]] double terminal_value(const Tree& tree, NodeId id) const;

  /// Includes the problem's terminal value in costs (the default after reset()) or leaves it out.
  /// All nodes of one tree must be made with the same setting.
  void include_terminal_value(bool is_included) {
    has_terminal_ = is_included && !problem_->terminal.is_empty();
  }

  [[nodiscard]] const MotionTable& motion() const { return motion_; }
  [[nodiscard]] const BeliefTable& beliefs() const { return beliefs_; }

 private:
  /// Information gain of all children of one node, by child.
  struct Gains {
    /// product of det(I + M P); moved to `sum` as a logarithm beyond 1e150
    alignas(32) double product[kMaxControls];
    alignas(32) double sum[kMaxControls];  ///< sum of gains, nats, or m² for the trace
  };
  bool keep_posterior(Tree& tree, NodeId id, double cos_yaw, double sin_yaw);
  /// Computes the feasible children's controls, poses and views.
  void move(const Node& node, double cos_yaw, double sin_yaw, Children& out);
  void look_from_children(int t, const Children& children, Gains& gains) const;
  void look_at_one(int m, int t, const Views& views, Gains& gains) const;
  void look_at_one_each(int m, int t, const Children& children, Gains& gains) const;
  /// Predicts blocks to depth t: fills touched_ (targets) and predicted_ (packed, strided).
  void predict_blocks(const Blocks& blocks, int t);
  void forget_blocks();
  [[nodiscard]] const double* predicted(int m, int t) const {
    const std::int32_t slot = slot_of_[index(m)];
    return slot < 0 ? beliefs_.open_loop(m, t) : &predicted_[kMaxPacked * index(slot)];
  }
  /// Returns the rest of the tour of the terminal value after the measurements of `blocks`.
  [[nodiscard]] TerminalValue::Rest rest_of_tour(const Blocks& blocks) const;
  /// Returns the stage cost of depth t with the predicted blocks and no measurement.
  [[nodiscard]] double predicted_cost(int t) const;
  struct Kept {
    std::size_t targets = 0;
    std::size_t doubles = 0;
  };
  /// Updates the predicted blocks with the information from `at` at depth t, and writes them to
  /// `room`.
  Kept update_blocks(const Pose2& at, double cos_yaw, double sin_yaw, int t, Tree::Room room);

  const SearchProblem* problem_ = nullptr;
  bool has_terminal_ = false;
  MotionTable motion_;
  BeliefTable beliefs_;
  SightTable sight_;
  CandidateGrid grid_;
  std::vector<std::int32_t> slot_of_;   ///< per target: index into predicted_; −1: untouched
  std::vector<std::uint16_t> touched_;  ///< targets, ascending
  std::vector<double> predicted_;
  std::span<const std::uint16_t> candidates_;
  std::vector<std::uint16_t> result_targets_;
  std::vector<double> result_;
};

}  // namespace vantage::planner
