#pragma once

#include <cstdint>
#include <vector>

#include "core/index.hpp"
#include "planner/problem/belief_table.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/averaged_block.hpp"
#include "planner/search/geodesic.hpp"
#include "planner/search/pointed_information.hpp"
#include "planner/search/tree.hpp"

namespace vantage::planner {

/// Least cost-to-go of a search node: admissible and consistent, from what the node knows and what
/// its robot can reach.
///
/// h(x, Σ, t) = Σ_{k=t+1..T} c(Σ̄_k), Σ̄_k = (ρᵖ(Σ̄_{k−1})⁻¹ + M̄ᵏ⁻ᵗ(x))⁻¹, with M̄ʲ over all places j
/// steps away or nearer, around obstacles for targets that stay where they are. For planar targets
/// that stay, the sum over looks of rank-one information replaces M̄ = λ_max I: with a ≤ b the
/// eigenvalues of the information at hand and E that of the looks so far, its determinant is at
/// most (a + E) b after one look or while a + E ≤ b, and ((a + b + E)/2)² else. For all other
/// planar targets the block averaged over directions (AveragedBlock) is a second bound; the larger
/// counts.
///
/// Targets that the node's history has not touched come from a table by distance (rings of a
/// quarter of a step, rounded inwards), filled as needed; one that cannot be reached any more costs
/// nothing to bound. Allocates nothing after construction.
/// Source: dissertation Thm 6 and app. G; the rank-one bound is ours (interlacing and Fiedler).
class InformationHeuristic {
 public:
  InformationHeuristic(int targets_max, int horizon_max);

  /// Tables `problem`; `beliefs` are those of the same problem, and both must outlive the queries.
  void reset(const SearchProblem& problem, const BeliefTable& beliefs);

  /// h of a node at `at` and `depth` with these blocks; −∞ when nothing bounds the information (a
  /// bearing sensor without a least range). O(targets in reach · steps left).
  [[nodiscard]] double cost_to_go(const Pose2& at, int depth, const Blocks& blocks) {
    return cost_to_go(at, depth, blocks, nullptr).all;
  }
  /// The same, and how much of it is of the targets that `apart` marks with 1.
  struct Parts {
    double all = 0.0;
    double apart = 0.0;
  };
  [[nodiscard]] Parts cost_to_go(const Pose2& at, int depth, const Blocks& blocks,
                                 const std::uint8_t* apart);

  /// What the stage cost of depth k = 1 … T is at least, on any plan; cost_to_go of the root is
  /// their sum, and that of any node is no less than the sum of those after it.
  [[nodiscard]] double stage_floor(int k) const { return stage_floors_[index(k)]; }

  /// Longest way of one step, m, rounded up.
  [[nodiscard]] double step_m() const { return step_m_; }
  /// Horizontal distance from which target m may be seen at most, m.
  [[nodiscard]] double sight_m(int m) const { return sights_m_[index(m)]; }
  [[nodiscard]] const GeodesicTable& ways() const { return ways_; }
  [[nodiscard]] bool stays(int m) const { return stays_[index(m)] != 0; }
  /// No process noise and no teammates' looks: its information is the sum of the own looks.
  [[nodiscard]] bool only_own_looks(int m) const { return only_own_looks_[index(m)] != 0; }
  [[nodiscard]] const StepMotion& motion(int m) const { return motions_[index(m)]; }
  [[nodiscard]] bool has_fixed(int m) const { return has_fixed_[index(m)] != 0; }
  /// Whether AveragedBlock bounds it: planar, the same A on both axes, no teammates' looks.
  [[nodiscard]] bool is_averaged(int m) const {
    return beliefs_->layout(m) != BlockLayout::kSpatial && !has_fixed(m) && motion(m).is_alike();
  }
  /// Cost of target m over the steps after `depth` when nobody looks any more at an untouched one.
  [[nodiscard]] double open_loop_rest(int m, int depth) const {
    return open_loop_rests_[at(m, depth)];
  }
  [[nodiscard]] double open_loop_rest(int depth) const { return total_rests_[index(depth)]; }
  /// What a look at target m tells at most when the way to it is between these and as many steps
  /// are made before it.
  [[nodiscard]] LookBound look_bound(int m, double nearest_m, double farthest_m, int steps) const;

 private:
  static constexpr int kRingsPerStep = 4;
  static constexpr int kRings = 96;

  [[nodiscard]] std::size_t at(int m, int depth) const {
    return index(m) * index(horizon_ + 1) + index(depth);
  }
  /// A way known to lie between these, m.
  struct Way {
    double nearest_m = 0.0;
    double farthest_m = 0.0;
  };
  /// Calls emit(k, measure) for k = t + 1 … T with the least trace or determinant of target m,
  /// the way to whose mean at depth k is way(k). False when it is not bounded.
  template <class WayAt, class Emit>
  bool for_each_step(int m, int t, const double* block, const WayAt& way, const Emit& emit) const;
  template <class WayAt>
  double rest(int m, int t, const double* block, const WayAt& way) const;
  double untouched_rest(int m, int t, double way_m);
  /// The ring of ways that `way_m` is in, and the ways that are in a ring.
  [[nodiscard]] int ring_of(double way_m) const;
  [[nodiscard]] Way ways_of(int ring) const;

  const SearchProblem* problem_ = nullptr;
  const BeliefTable* beliefs_ = nullptr;
  int horizon_ = 0;
  double step_m_ = 0.0;
  GeodesicTable ways_;
  std::vector<Eigen::Vector2d> points_;
  std::vector<double> sights_m_;
  std::vector<StepMotion> motions_;
  std::vector<std::uint8_t> stays_;
  std::vector<std::uint8_t> has_fixed_;
  std::vector<std::uint8_t> only_own_looks_;
  std::vector<double> open_loop_rests_;
  std::vector<double> total_rests_;
  std::vector<double> stage_floors_;
  std::vector<double> ring_rests_;         ///< [m][t][ring]; NaN: not worked out
  std::vector<std::uint8_t> ring_filled_;  ///< [m][t]: whether its rings hold anything of now
  std::vector<std::int32_t> slots_;        ///< per target: where its block is, −1: untouched
};

}  // namespace vantage::planner
