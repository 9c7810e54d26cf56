#pragma once

#include <Eigen/Core>

#include "core/linear.hpp"
#include "models/target/kind.hpp"

namespace vantage::models {

inline constexpr int kMinTargetDim = 2;
inline constexpr int kMaxTargetDim = 4;

/// State and matrices of one target: 2, 3 or 4 rows, stored in place without heap memory.
using StateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, kUnaligned, kMaxTargetDim, 1>;
using StateMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, kUnaligned, kMaxTargetDim, kMaxTargetDim>;

/// Parameters of a damped oscillator on each axis: ÿ = −(σ_v²/σ_p²)(y − c) − γ ẏ + white noise of
/// density 2 γ σ_v². Its stationary distribution has position N(c, σ_p²) and velocity N(0, σ_v²),
/// independent of each other.
struct DampedOscillator {
  Eigen::Vector2d center_m = Eigen::Vector2d::Zero();            ///< m; c
  Eigen::Vector2d position_sigma_m = Eigen::Vector2d::Ones();    ///< m; σ_p
  Eigen::Vector2d velocity_sigma_mps = Eigen::Vector2d::Ones();  ///< m/s; σ_v
  Eigen::Vector2d damping_per_s = Eigen::Vector2d::Ones();       ///< 1/s; γ

  bool operator==(const DampedOscillator&) const = default;
};

/// Linear motion of one target, y' = c + A (y − c) + w, w ~ N(0, W); see TargetLaw for A, c and W
/// of each kind. The position is the first `position_dim` components of the state. Source:
/// dissertation, sections 2.H, 3.4, 4.2, 4.F.3.
struct TargetModel {
  TargetKind kind = TargetKind::kRandomWalk;
  int position_dim = 2;  ///< 2 or 3; models with a velocity are planar
  /// process noise: m²/s for a random walk, m²/s³ for a double integrator, m² for growing
  /// uncertainty; other kinds do not use it
  double q = 0.0;
  DampedOscillator oscillator = {};  ///< damped oscillator only

  bool operator==(const TargetModel&) const = default;

  /// True if the state has a velocity.
  [[nodiscard]] bool has_velocity() const;
  /// Returns the rows of the state: 4 with a velocity, else position_dim.
  [[nodiscard]] int dim() const;
  /// Returns A, dim × dim.
  [[nodiscard]] StateMatrix transition(double dt_s) const;
  /// Returns c + A (y − c).
  [[nodiscard]] StateVector expected(const StateVector& y, double dt_s) const;
  /// Returns W, dim × dim. `steps_unseen` matters only for kinds with noise that grows while the
  /// target is unseen.
  [[nodiscard]] StateMatrix process_noise(double dt_s, int steps_unseen = 1) const;
  /// Returns W accumulated from `from_steps` to `to_steps` after the target was last seen, for a
  /// kind whose noise depends on the time unseen (TargetLaw::unseen_noise). Growing uncertainty: q
  /// (g(to) − g(from)) I, g(k) = Σ j over integers j < k, interpolated linearly between integers,
  /// so that partial steps add up. Precondition: 0 ≤ from_steps ≤ to_steps.
  [[nodiscard]] StateMatrix grown_noise(double from_steps, double to_steps) const;
  /// Returns the model used in planning. Growing uncertainty becomes a random walk with the noise
  /// of the next step, because the planned measurements decide when the growth ends. Other models
  /// are unchanged.
  [[nodiscard]] TargetModel as_planned(double steps_unseen, double step_s) const;
};

}  // namespace vantage::models
