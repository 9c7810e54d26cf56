#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/index.hpp"
#include "planner/problem/block_kernels.hpp"
#include "planner/problem/problem.hpp"

namespace vantage::planner {

/// Table of the quantities that all nodes of a depth share: predicted target positions, their
/// open-loop covariances and the open-loop cost. "Open loop" means without measurements of this
/// search, but with the teammates' fixed information.
///
/// reset() is O(T·M). It allocates only up to the sizes given to the constructor.
class BeliefTable {
 public:
  BeliefTable(int targets_max, int horizon_max);

  void reset(const SearchProblem& problem);

  [[nodiscard]] int target_count() const { return static_cast<int>(layouts_.size()); }
  [[nodiscard]] BlockLayout layout(int m) const { return layouts_[index(m)]; }
  [[nodiscard]] int position_dim(int m) const { return layout(m) == BlockLayout::kSpatial ? 3 : 2; }

  /// Returns the predicted position of target m at depth t = 0 … T (z = 0 for planar targets).
  [[nodiscard]] const Eigen::Vector3d& mean_m(int m, int t) const { return means_[at(m, t)]; }
  /// Returns the predicted velocity of target m at depth t; zero for a target without velocity.
  [[nodiscard]] const Eigen::Vector2d& velocity_mps(int m, int t) const {
    return velocities_[at(m, t)];
  }
  /// Returns the packed covariance of target m at depth t without measurements of this search.
  [[nodiscard]] const double* open_loop(int m, int t) const {
    return &open_loop_[kMaxPacked * at(m, t)];
  }
  /// Returns the determinant or trace of open_loop(m, t), depending on the cost.
  [[nodiscard]] double open_loop_measure(int m, int t) const { return measures_[at(m, t)]; }
  /// Returns 1 / open_loop_measure(m, t).
  [[nodiscard]] double open_loop_per_measure(int m, int t) const { return per_measures_[at(m, t)]; }
  /// Returns the stage cost of depth t without any measurement.
  [[nodiscard]] double open_loop_cost(int t) const { return stage_costs_[index(t)]; }

  /// Predicts the block of target m from depth t − 1 to depth t, including the teammates'
  /// information at t.
  void predict_into(int m, int t, const double* in, double* out) const;

  [[nodiscard]] CostKind cost() const { return cost_; }
  /// True if teammates contribute information that does not depend on this robot's plan.
  [[nodiscard]] bool has_fixed() const { return has_fixed_; }

 private:
  [[nodiscard]] std::size_t at(int m, int t) const { return index(t) * layouts_.size() + index(m); }

  CostKind cost_ = CostKind::kLogDet;
  bool has_fixed_ = false;
  std::vector<BlockLayout> layouts_;
  std::vector<StepMotion> motions_;
  std::vector<Eigen::Vector3d> means_;
  std::vector<Eigen::Vector2d> velocities_;
  std::vector<double> open_loop_;
  std::vector<double> measures_;
  std::vector<double> per_measures_;
  std::vector<double> stage_costs_;
  std::vector<PackedInformation> fixed_;  ///< indexed by [t − 1][m]
  std::vector<std::uint8_t> is_fixed_;    ///< 1 where fixed_ is not zero
};

/// Packs the upper triangle of a planar, spatial or moving covariance.
void pack(BlockLayout layout, const models::StateMatrix& covariance, double* out);
/// Returns the full symmetric matrix of a packed block.
models::StateMatrix unpack(BlockLayout layout, const double* packed);

}  // namespace vantage::planner
