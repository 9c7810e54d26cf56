#pragma once

#include <Eigen/Core>

#include "core/linear.hpp"

namespace vantage::models {

inline constexpr int kMinTargetDim = 2;
inline constexpr int kMaxTargetDim = 4;

/// State and matrices of one target: 2, 3 or 4 rows, stored in place (never on the heap).
using StateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, kUnaligned, kMaxTargetDim, 1>;
using StateMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, kUnaligned, kMaxTargetDim, kMaxTargetDim>;

enum class TargetKind {
  kStatic,              ///< y' = y
  kRandomWalk,          ///< y' = y + w, W = qτ I
  kDoubleIntegrator,    ///< (y₁, y₂, ẏ₁, ẏ₂) with white acceleration of density q
  kGrowingUncertainty,  ///< y' = y + w, W = q k I with k the steps since the target was last seen,
                        ///< as the step begins
  kDampedOscillator,  ///< (y₁, y₂, ẏ₁, ẏ₂) that keeps to its surroundings: Surroundings
};

/// What a damped oscillator is, axis by axis: ÿ = −(σ_v²/σ_p²)(y − c) − γ ẏ + white noise of
/// density 2 γ σ_v². Whatever is known at first, in the long run it is N(c, σ_p²), its velocity
/// N(0, σ_v²), and the two are independent.
struct Surroundings {
  Eigen::Vector2d center_m = Eigen::Vector2d::Zero();            ///< c
  Eigen::Vector2d position_sigma_m = Eigen::Vector2d::Ones();    ///< σ_p
  Eigen::Vector2d velocity_sigma_mps = Eigen::Vector2d::Ones();  ///< σ_v
  Eigen::Vector2d damping_per_s = Eigen::Vector2d::Ones();       ///< γ
};

/// Linear motion of one target, y' = c + A (y − c) + w, w ~ N(0, W); c = 0 but for a damped
/// oscillator. The position is the first `position_dim` components of the state.
/// Source: dissertation ch. 2 H, 3.4, 4.2, F.3; oscillator: Uhlenbeck, Ornstein, On the theory of
/// the Brownian motion (1930), part II.
struct TargetModel {
  TargetKind kind = TargetKind::kRandomWalk;
  int position_dim = 2;  ///< 2 or 3; what has a velocity is planar
  double q = 0.0;  ///< m²/s for a random walk, m²/s³ for a double integrator, m² for growing
  Surroundings surroundings = {};  ///< of a damped oscillator

  /// Whether the state holds a velocity: a double integrator's and a damped oscillator's.
  [[nodiscard]] bool has_velocity() const {
    return kind == TargetKind::kDoubleIntegrator || kind == TargetKind::kDampedOscillator;
  }
  /// Rows of the state: 4 with a velocity, else position_dim.
  [[nodiscard]] int dim() const;
  /// A, dim × dim.
  [[nodiscard]] StateMatrix transition(double dt_s) const;
  /// c + A (y − c).
  [[nodiscard]] StateVector expected(const StateVector& y, double dt_s) const;
  /// W, dim × dim. `steps_unseen` matters to growing uncertainty alone.
  [[nodiscard]] StateMatrix process_noise(double dt_s, int steps_unseen = 1) const;
  /// W of growing uncertainty between so many steps after the target was last seen and so many:
  /// q (g(to) − g(from)) I, g(k) = Σ j over whole j < k, linear between whole steps, so that cut
  /// steps add up. Precondition: 0 ≤ from_steps ≤ to_steps.
  [[nodiscard]] StateMatrix grown_noise(double from_steps, double to_steps) const;
  /// As a plan counts with it. Growing uncertainty is a random walk with the noise of the coming
  /// step all along, since the looks that end its growth are what the plan decides; any other
  /// model is as it is.
  [[nodiscard]] TargetModel as_planned(double steps_unseen, double step_s) const;
};

}  // namespace vantage::models
