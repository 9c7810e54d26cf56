#pragma once

#include <cstdint>
#include <vector>

#include "planner/search/belief_table.hpp"
#include "planner/search/motion_table.hpp"
#include "planner/search/problem.hpp"
#include "planner/search/tree.hpp"

namespace vantage::planner {

inline constexpr int kMaxControls = 64;

/// The children of one node: the feasible controls in ascending order.
struct Children {
  int count = 0;
  std::int16_t control[kMaxControls];
  Pose2 world_from_body[kMaxControls];
  double cost[kMaxControls];  ///< accumulated J
};

/// One expansion: collision-free motion, information of every sensor about every target in sight,
/// accumulated cost. All searches share it; they differ in what they expand and what they prune.
///
/// A parent is predicted once for all children; a child costs one small determinant for each
/// target in its sight, and its covariances are worked out only when it is expanded or compared.
/// Allocates nothing after construction.
class Expander {
 public:
  Expander(int targets_max, int horizon_max, int teammates_max);

  /// Tables `problem`, which must outlive the queries. Precondition: require_valid(problem).
  void reset(const SearchProblem& problem);

  [[nodiscard]] Node root() const;

  /// Fills `out` with the children of `id`, whose blocks it keeps in `tree`. False when the arena
  /// is full (`out` is then empty).
  bool expand(Tree& tree, NodeId id, Children& out);

  /// Works out and keeps the blocks of `id`, unless they are. Its parent must have been expanded.
  bool ensure_posterior(Tree& tree, NodeId id);

  /// Cost of standing still at `id`'s pose for the steps left after its depth, added to its own.
  /// Precondition: has_posterior(id).
  [[nodiscard]] double cost_of_hovering(const Tree& tree, NodeId id);

  /// True when every block of a, plus εI, dominates (⪰) that of b: b knows at least as much.
  /// Precondition: both at one depth, with posteriors. Exact; see planner::dominates.
  [[nodiscard]] bool is_redundant(const Tree& tree, NodeId a, double epsilon, NodeId b) const;

  /// Upper bound on the information that any plan can gather gives this lower bound on J_T: Thm 6
  /// at the root, Σ_t c(Σ̄_t) with M̄ʲ over everything reachable in j steps. O(T·M).
  [[nodiscard]] double lower_bound_at_root() const;

  [[nodiscard]] const MotionTable& motion() const { return motion_; }
  [[nodiscard]] const BeliefTable& beliefs() const { return beliefs_; }

 private:
  /// Information of one look from `at` about target m at depth t; false when it is not seen.
  [[nodiscard]] bool look(int m, int t, const Pose2& at, double cos_yaw, double sin_yaw,
                          PackedInformation& out) const;
  [[nodiscard]] bool look_planar(const models::SensorModel& sensor, double cos_half_fov,
                                 double dx_m, double dy_m, double cos_yaw, double sin_yaw,
                                 PackedInformation& sum) const;
  /// Targets near enough to be seen from within `reach_m` of `p_m` at depth t, into candidates_.
  void find_candidates(const Eigen::Vector2d& p_m, double reach_m, int t);
  /// Predicts blocks into depth t: fills touched_ (targets) and predicted_ (packed, strided).
  void predict_blocks(const Blocks& blocks, int t);
  void forget_blocks();
  [[nodiscard]] const double* predicted(int m, int t) const {
    const std::int32_t slot = slot_of_[static_cast<std::size_t>(m)];
    return slot < 0 ? beliefs_.open_loop(m, t)
                    : &predicted_[kMaxPacked * static_cast<std::size_t>(slot)];
  }
  /// Stage cost of depth t with the predicted blocks and no look.
  [[nodiscard]] double predicted_cost(int t) const;
  /// Updates the predicted blocks by a look from `at` at depth t into result_; counts targets.
  void update_blocks(const Pose2& at, int t);

  const SearchProblem* problem_ = nullptr;
  MotionTable motion_;
  BeliefTable beliefs_;
  std::vector<double> cos_half_fov_;  ///< per sensor, −2 for a full turn
  double range_max_m_ = 0.0;          ///< over all sensors
  bool has_obstacles_ = false;
  std::vector<std::int32_t> slot_of_;   ///< per target: index into predicted_, −1: untouched
  std::vector<std::uint16_t> touched_;  ///< by ascending target
  std::vector<double> predicted_;
  std::vector<std::uint16_t> candidates_;
  std::vector<std::uint16_t> result_targets_;
  std::vector<double> result_;
};

}  // namespace vantage::planner
