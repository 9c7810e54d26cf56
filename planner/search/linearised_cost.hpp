#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/index.hpp"
#include "planner/problem/belief_table.hpp"
#include "planner/problem/information_measure.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/tree.hpp"

namespace vantage::planner {

/// The cost of planar targets as an affine function of the information of all measurements: a lower
/// bound everywhere, exact at its reference.
///
/// J is convex in the information of all measurements: the Riccati step is operator concave, and −2
/// I(y_{1:T}; z_{1:T}) has the Hessian of −log det. So around any reference R, J(M) ≥ J(R) + Σ ⟨G,
/// R⟩ − Σ ⟨G, M⟩ with G = −∂J/∂M at R, which is additive over steps, targets and robots. A
/// reference is a symmetric 2×2 matrix per target and depth, 1/m², in three floats.
///
/// Allocates nothing after construction. Source: ours (reverse differentiation of the recursion).
class LinearisedCost {
 public:
  LinearisedCost(int targets_max, int horizon_max);

  /// Tabulates the targets of `problem`. `problem` and `beliefs` must outlive the queries. The cost
  /// is J_T for kLogDet and −2 I for kMutual.
  void reset(const SearchProblem& problem, const BeliefTable& beliefs, InformationMeasure measure);

  /// Returns the number of floats in a reference.
  [[nodiscard]] std::size_t reference_size() const { return 3 * index(targets_) * index(horizon_); }
  /// Returns the index in a reference of the matrix of target m at depth k ≥ 1.
  [[nodiscard]] std::size_t at(int m, int k) const {
    return index(m) * index(horizon_) + index(k - 1);
  }

  /// Marks all targets as out of reach at all depths. Unreached entries of a reference are ignored.
  void clear_reached();
  /// Marks target m as in reach at depth k.
  void set_reached(int m, int k) { reached_[at(m, k)] = 1; }
  [[nodiscard]] bool is_reached(int m, int k) const { return reached_[at(m, k)] != 0; }

  /// Returns J(R) + Σ ⟨G, R⟩ of target m over the depths after `depth`, where its belief is
  /// `block`.
  double linearise(int m, int depth, const double* block, const float* reference);

  /// Symmetric 2×2 matrix, m².
  struct Gradient {
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
  };
  /// Returns G of target m at depth k.
  [[nodiscard]] const Gradient& gradient(int m, int k) const { return gradients_[at(m, k)]; }
  /// Returns the least eigenvalue of target m's position information at depth k without
  /// measurements, 1/m².
  [[nodiscard]] double known(int m, int k) const { return known_[at(m, k)]; }
  /// Returns w: a measurement at depth k that raises the information of a direction by a factor f
  /// lowers the cost by at most w ln f. J_T sums over the states from depth k on. By data
  /// processing along the Markov chain no later state gains more than the state at k.
  [[nodiscard]] double weight(int k) const {
    return measure_ == InformationMeasure::kLogDet ? 1.0 + horizon_ - k : 1.0;
  }

 private:
  template <int kDim>
  double linearise_block(int m, int depth, const double* block, const float* reference);

  const SearchProblem* problem_ = nullptr;
  const BeliefTable* beliefs_ = nullptr;
  InformationMeasure measure_ = InformationMeasure::kLogDet;
  int targets_ = 0;
  int horizon_ = 0;
  std::vector<Gradient> gradients_;           ///< G of target m at depth k, at index at(m, k)
  std::vector<double> known_;                 ///< known(m, k), at index at(m, k)
  std::vector<std::uint8_t> reached_;         ///< is_reached(m, k), at index at(m, k)
  std::vector<Eigen::Matrix4d> covariances_;  ///< by depth, after the measurements
  std::vector<Eigen::Matrix4d> predicted_;    ///< by depth, before the measurements
};

}  // namespace vantage::planner
