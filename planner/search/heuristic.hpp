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

/// Lower bound of a search node's cost-to-go, admissible and consistent, from the node's belief and
/// the robot's reachable positions.
///
/// h(x, Σ, t) = Σ_{k=t+1..T} c(Σ̄_k), Σ̄_k = (ρᵖ(Σ̄_{k−1})⁻¹ + M̄ᵏ⁻ᵗ(x))⁻¹, where c is the stage
/// cost, ρᵖ predicts one step, and M̄ʲ bounds the information from all positions within j steps.
/// For static targets, distances are path lengths around obstacles. For planar static targets, a
/// sum of rank-one information over the measurements replaces M̄ = λ_max I. Let a ≤ b be the
/// eigenvalues of the present information, and E the sum of the non-zero eigenvalues of the
/// measurements. The determinant is at most (a + E) b after one measurement or while a + E ≤ b,
/// else ((a + b + E)/2)². For all other planar targets the direction-averaged block (AveragedBlock)
/// gives a second bound; the larger is used.
///
/// For targets not yet measured on the path to the node, a table stores values by distance (rings
/// of a quarter step, rounded inwards). The table is filled on demand. Targets out of reach need no
/// computation. Allocates nothing after construction.
/// Source: dissertation Thm 6 and app. G; the rank-one bound is ours (interlacing and Fiedler).
class InformationHeuristic {
 public:
  InformationHeuristic(int targets_max, int horizon_max);

  /// Tabulates `problem`. `beliefs` must belong to `problem`. Both must outlive the queries.
  void reset(const SearchProblem& problem, const BeliefTable& beliefs);

  /// Returns h of a node at `at` and `depth` with the belief `blocks`; −∞ if the information is
  /// unbounded (a bearing sensor without a minimum range). O(targets in reach · steps left).
  [[nodiscard]] double cost_to_go(const Pose2& at, int depth, const Blocks& blocks) {
    return cost_to_go(at, depth, blocks, nullptr).all;
  }
  /// The value h, and the part of h from the targets marked 1 in `apart`.
  struct Parts {
    double all = 0.0;
    double apart = 0.0;
  };
  [[nodiscard]] Parts cost_to_go(const Pose2& at, int depth, const Blocks& blocks,
                                 const std::uint8_t* apart);

  /// Returns a lower bound of the stage cost at depth k = 1 … T for every plan. The sum of all
  /// stage floors is cost_to_go of the root. cost_to_go of any node is at least the sum of the
  /// floors of the depths after the node.
  [[nodiscard]] double stage_floor(int k) const { return stage_floors_[index(k)]; }

  /// Returns the length of the longest step, m, rounded up.
  [[nodiscard]] double step_m() const { return step_m_; }
  /// Returns the largest horizontal distance at which target m is visible, m.
  [[nodiscard]] double sight_m(int m) const { return sights_m_[index(m)]; }
  [[nodiscard]] const GeodesicTable& geodesics() const { return geodesics_; }
  [[nodiscard]] bool has_static_position(int m) const {
    return has_static_position_[index(m)] != 0;
  }
  /// True if target m has no process noise and no teammates' information, so that its information
  /// is the sum of the robot's own measurements.
  [[nodiscard]] bool has_only_own_information(int m) const {
    return has_only_own_information_[index(m)] != 0;
  }
  [[nodiscard]] const StepMotion& motion(int m) const { return motions_[index(m)]; }
  [[nodiscard]] bool has_fixed(int m) const { return has_fixed_[index(m)] != 0; }
  /// True if AveragedBlock bounds target m: planar, same A on both axes, no teammates' information,
  /// no sensor measures its velocity.
  [[nodiscard]] bool is_averaged(int m) const {
    return beliefs_->layout(m) != BlockLayout::kSpatial && !has_fixed(m) &&
           motion(m).is_isotropic() &&
           !(measures_velocity_ && beliefs_->layout(m) == BlockLayout::kMoving);
  }
  /// Returns the cost of target m over the steps after `depth` if the target is never measured.
  [[nodiscard]] double open_loop_rest(int m, int depth) const {
    return open_loop_rests_[at(m, depth)];
  }
  [[nodiscard]] double open_loop_rest(int depth) const { return total_rests_[index(depth)]; }
  /// Returns a bound of the information of one measurement of target m after `steps` steps, if the
  /// path length to the target is between `nearest_m` and `farthest_m`.
  [[nodiscard]] LookBound look_bound(int m, double nearest_m, double farthest_m, int steps) const;

 private:
  static constexpr int kRingsPerStep = 4;
  static constexpr int kRings = 96;

  [[nodiscard]] std::size_t at(int m, int depth) const {
    return index(m) * index(horizon_ + 1) + index(depth);
  }
  /// Bounds of a path length, m.
  struct PathRange {
    double nearest_m = 0.0;
    double farthest_m = 0.0;
  };
  /// Calls emit(k, measure) for k = t + 1 … T with the least trace or determinant of target m.
  /// path(k) bounds the path length to the target's mean at depth k. Returns false if the
  /// information is unbounded.
  template <class PathAt, class Emit>
  bool for_each_step(int m, int t, const double* block, const PathAt& path, const Emit& emit) const;
  template <class PathAt>
  double rest(int m, int t, const double* block, const PathAt& path) const;
  double untouched_rest(int m, int t, double path_m);
  /// Return the ring that contains the path length `path_m`, and the path lengths of a ring.
  [[nodiscard]] int ring_of(double path_m) const;
  [[nodiscard]] PathRange paths_of_ring(int ring) const;

  const SearchProblem* problem_ = nullptr;
  const BeliefTable* beliefs_ = nullptr;
  int horizon_ = 0;
  double step_m_ = 0.0;
  bool measures_velocity_ = false;  ///< true: a sensor measures velocities
  GeodesicTable geodesics_;
  std::vector<Eigen::Vector2d> points_;
  std::vector<double> sights_m_;
  std::vector<double> speeds_mps_;  ///< per target: largest predicted speed
  std::vector<StepMotion> motions_;
  std::vector<std::uint8_t> has_static_position_;
  std::vector<std::uint8_t> has_fixed_;
  std::vector<std::uint8_t> has_only_own_information_;
  std::vector<double> open_loop_rests_;
  std::vector<double> total_rests_;
  std::vector<double> stage_floors_;
  std::vector<double> ring_rests_;  ///< [m][t][ring]; NaN: not computed
  std::vector<std::uint8_t>
      ring_filled_;  ///< [m][t]: 1 if the rings were computed for the present problem
  std::vector<std::int32_t> slots_;  ///< per target: offset of its block; −1: untouched
};

}  // namespace vantage::planner
