#pragma once

#include "planner/problem/block_kernels.hpp"

namespace vantage::planner {

/// A planar block averaged over all rotations and reflections of the plane. The average is the same
/// for each axis.
///
/// Averaging the information matrix Ω over O(2) gives a lower bound of every cost. The Riccati step
/// is operator concave and monotone in Ω and isotropic. The recursion on averages uses ½ tr M · I
/// for each measurement M; its result is at least the average of the true Ω_k. Also, log det Ω is
/// concave and tr Ω⁻¹ is convex. For a measurement in one direction the bound uses half of its
/// information in every direction; M̄ = λ_max I uses all of it. The step is isotropic if A is the
/// same on both axes. If W differs between the axes, the smaller W is used. It bounds both, because
/// with equal A the two W differ by a factor.
/// Source: ours; concavity of the Riccati map as in Anderson & Duffin 1969 (parallel sum).
class AveragedBlock {
 public:
  AveragedBlock() = default;
  /// Averages a packed planar or moving covariance, which must be positive definite.
  AveragedBlock(BlockLayout layout, const double* b) : moves_(layout == BlockLayout::kMoving) {
    if (!moves_) {
      position_ = 2.0 * det2(b) / (b[0] + b[2]);  // 1 / (½ tr P⁻¹)
      return;
    }
    // Ω = [Ωp Ωc; Ωcᵀ Ωv] by blocks: S = V − Cᵀ P⁻¹ C, X = P⁻¹ C.
    const double det_p = det2(b);
    const double i00 = b[2] / det_p;
    const double i01 = -b[1] / det_p;
    const double i11 = b[0] / det_p;
    const double x00 = i00 * b[3] + i01 * b[5];
    const double x01 = i00 * b[4] + i01 * b[6];
    const double x10 = i01 * b[3] + i11 * b[5];
    const double x11 = i01 * b[4] + i11 * b[6];
    const double s00 = b[7] - (b[3] * x00 + b[5] * x10);
    const double s01 = b[8] - (b[3] * x01 + b[5] * x11);
    const double s11 = b[9] - (b[4] * x01 + b[6] * x11);
    const double det_s = s00 * s11 - s01 * s01;
    const double j00 = s11 / det_s;  // S⁻¹
    const double j01 = -s01 / det_s;
    const double j11 = s00 / det_s;
    const double v = 0.5 * (j00 + j11);
    const double c = -0.5 * (x00 * j00 + (x01 + x10) * j01 + x11 * j11);
    const double p = 0.5 * (i00 + i11 + (x00 * x00 + x10 * x10) * j00 +
                            2.0 * (x00 * x01 + x10 * x11) * j01 + (x01 * x01 + x11 * x11) * j11);
    const double det = p * v - c * c;
    position_ = v / det;
    cross_ = -c / det;
    velocity_ = p / det;
  }

  /// Precondition: w.is_isotropic().
  void predict(const StepMotion& w) {
    if (!moves_) {
      position_ += w.position;
      return;
    }
    if (w.has_axis_motion) {
      const AxisMotion& least = w.x.position <= w.y.position ? w.x : w.y;
      const auto [a, b, c, d, position, cross, velocity] = least;
      const double p = position_;
      position_ = a * a * p + 2.0 * a * b * cross_ + b * b * velocity_ + position;
      const double crossed = a * c * p + (a * d + b * c) * cross_ + b * d * velocity_ + cross;
      velocity_ = c * c * p + 2.0 * c * d * cross_ + d * d * velocity_ + velocity;
      cross_ = crossed;
      return;
    }
    const double h = w.step_s;
    position_ += 2.0 * h * cross_ + h * h * velocity_ + w.position;
    cross_ += h * velocity_ + w.cross;
    velocity_ += w.velocity;
  }

  /// Applies a measurement with the information `strength` in every direction.
  void update(double strength) {
    const double scale = 1.0 / (1.0 + strength * position_);
    velocity_ -= strength * cross_ * cross_ * scale;
    cross_ *= scale;
    position_ *= scale;
  }

  [[nodiscard]] double determinant() const {
    const double axis = moves_ ? position_ * velocity_ - cross_ * cross_ : position_;
    return axis * axis;
  }
  [[nodiscard]] double trace() const { return 2.0 * (position_ + velocity_); }

 private:
  bool moves_ = false;
  double position_ = 1.0;
  double cross_ = 0.0;
  double velocity_ = 0.0;
};

}  // namespace vantage::planner
