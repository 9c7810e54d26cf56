#pragma once

#include <Eigen/Core>

#include "core/linear.hpp"

namespace vantage::models {

inline constexpr int kMaxTargetDim = 4;

/// State and matrices of one target: 2, 3 or 4 rows, stored in place (never on the heap).
using StateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, kUnaligned, kMaxTargetDim, 1>;
using StateMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, kUnaligned, kMaxTargetDim, kMaxTargetDim>;

enum class TargetKind {
  kStatic,              ///< y' = y
  kRandomWalk,          ///< y' = y + w, W = qτ I
  kDoubleIntegrator,    ///< (y₁, y₂, ẏ₁, ẏ₂) with white acceleration of density q
  kGrowingUncertainty,  ///< y' = y + w, W = q k I with k the steps since the target was last seen
};

/// Linear motion of one target, y' = A y + w, w ~ N(0, W). The position is the first
/// `position_dim` components of the state.
/// Source: dissertation ch. 2 H, 3.4, 4.2, F.3.
struct TargetModel {
  TargetKind kind = TargetKind::kRandomWalk;
  int position_dim = 2;  ///< 2 or 3; a double integrator is planar
  double q = 0.0;  ///< m²/s for a random walk, m²/s³ for a double integrator, m² for growing

  /// Rows of the state: 4 for a double integrator, else position_dim.
  [[nodiscard]] int dim() const;
  /// A, dim × dim.
  [[nodiscard]] StateMatrix transition(double dt_s) const;
  /// W, dim × dim. `steps_unseen` matters to growing uncertainty alone.
  [[nodiscard]] StateMatrix process_noise(double dt_s, int steps_unseen = 1) const;
};

}  // namespace vantage::models
