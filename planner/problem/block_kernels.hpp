#pragma once

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"

// Covariance arithmetic on packed blocks, the inner loop of every search. Legend:
//   P  position covariance, C = cov(position, velocity), V velocity covariance
//   M  information of one position measurement, G = (I + M P)⁻¹ M
// Information about a moving target's whole state is packed like its block (PackedInformation).
// Three layouts, by the target's state:
//   kPlanar  (x, y)            [Pxx Pxy Pyy]
//   kSpatial (x, y, z)         [Pxx Pxy Pxz Pyy Pyz Pzz]
//   kMoving  (x, y, ẋ, ẏ)      [Pxx Pxy Pyy  Cxx Cxy Cyx Cyy  Vxx Vxy Vyy]
// Results agree with the more general models/belief up to rounding (tested).

namespace vantage::planner {

enum class BlockLayout { kPlanar, kSpatial, kMoving };

inline constexpr int kMaxPacked = 10;

constexpr int packed_size(BlockLayout layout) {
  return layout == BlockLayout::kPlanar ? 3 : layout == BlockLayout::kSpatial ? 6 : 10;
}

/// Information about a target's position (symmetric 2×2 or 3×3), packed like the position part of a
/// block. If `is_of_state`: information about a moving target's state, packed like its block.
struct PackedInformation {
  double m[kMaxPacked] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  bool is_of_state = false;
};

/// Motion of one axis over one step: A = [a b; c d] and W = [position cross; cross velocity].
struct AxisMotion {
  double a = 1.0;
  double b = 0.0;
  double c = 0.0;
  double d = 1.0;
  double position = 0.0;
  double cross = 0.0;
  double velocity = 0.0;

  bool operator==(const AxisMotion&) const = default;
};

/// One step of prediction: the distinct entries of the target model's A and W. A freely moving
/// target (A = [1 step_s; 0 1] on both axes) has one W for both axes. Any other motion, such as
/// that of a damped oscillator (`has_axis_motion`), has its own A and W on each axis.
struct StepMotion {
  double step_s = 0.5;
  double position = 0.0;  ///< added to the diagonal of P
  double cross = 0.0;     ///< added to the diagonal of C
  double velocity = 0.0;  ///< added to the diagonal of V
  bool has_axis_motion = false;
  AxisMotion x = {};  ///< used if has_axis_motion
  AxisMotion y = {};

  /// True if A is the same on both axes.
  [[nodiscard]] bool is_isotropic() const {
    return !has_axis_motion || (x.a == y.a && x.b == y.b && x.c == y.c && x.d == y.d);
  }
};

/// Returns the motion of `model` over one step.
StepMotion step_motion(const models::TargetModel& model, double step_s);

inline double det2(const double* p) { return p[0] * p[2] - p[1] * p[1]; }

/// Computes the determinant by pivots. Cofactors would lose precision for a block that is certain
/// in two directions and uncertain in the third (after a camera's measurement).
inline double det3(const double* p) {
  const double l1 = p[1] / p[0];
  const double l2 = p[2] / p[0];
  const double d1 = p[3] - l1 * p[1];
  const double x = p[4] - l1 * p[2];
  return p[0] * (d1 * (p[5] - l2 * p[2]) - x * x);
}

/// Returns det Σ of one block.
inline double determinant(BlockLayout layout, const double* b) {
  switch (layout) {
    case BlockLayout::kPlanar:
      return det2(b);
    case BlockLayout::kSpatial:
      return det3(b);
    case BlockLayout::kMoving:
      break;
  }
  // det P · det(V − Cᵀ P⁻¹ C)
  const double det_p = det2(b);
  const double i00 = b[2] / det_p;
  const double i01 = -b[1] / det_p;
  const double i11 = b[0] / det_p;
  const double x0 = i00 * b[3] + i01 * b[5];  // P⁻¹ C, first column
  const double x1 = i01 * b[3] + i11 * b[5];
  const double y0 = i00 * b[4] + i01 * b[6];  // second column
  const double y1 = i01 * b[4] + i11 * b[6];
  const double s00 = b[7] - (b[3] * x0 + b[5] * x1);
  const double s01 = b[8] - (b[3] * y0 + b[5] * y1);
  const double s11 = b[9] - (b[4] * y0 + b[6] * y1);
  return det_p * (s00 * s11 - s01 * s01);
}

inline double trace(BlockLayout layout, const double* b) {
  switch (layout) {
    case BlockLayout::kPlanar:
      return b[0] + b[2];
    case BlockLayout::kSpatial:
      return b[0] + b[3] + b[5];
    case BlockLayout::kMoving:
      break;
  }
  return b[0] + b[2] + b[7] + b[9];
}

/// Predicts a moving block with separate A and W for each axis.
inline void predict_per_axis(const AxisMotion& x, const AxisMotion& y, const double* in,
                             double* out) {
  const double p0 = in[0];
  const double p1 = in[1];
  const double p2 = in[2];
  const double c0 = in[3];
  const double c1 = in[4];
  const double c2 = in[5];
  const double c3 = in[6];
  const double v0 = in[7];
  const double v1 = in[8];
  const double v2 = in[9];
  out[0] = x.a * x.a * p0 + 2.0 * x.a * x.b * c0 + x.b * x.b * v0 + x.position;
  out[1] = x.a * y.a * p1 + x.a * y.b * c1 + x.b * y.a * c2 + x.b * y.b * v1;
  out[2] = y.a * y.a * p2 + 2.0 * y.a * y.b * c3 + y.b * y.b * v2 + y.position;
  out[3] = x.a * x.c * p0 + (x.a * x.d + x.b * x.c) * c0 + x.b * x.d * v0 + x.cross;
  out[4] = x.a * y.c * p1 + x.a * y.d * c1 + x.b * y.c * c2 + x.b * y.d * v1;
  out[5] = y.a * x.c * p1 + y.a * x.d * c2 + y.b * x.c * c1 + y.b * x.d * v1;
  out[6] = y.a * y.c * p2 + (y.a * y.d + y.b * y.c) * c3 + y.b * y.d * v2 + y.cross;
  out[7] = x.c * x.c * p0 + 2.0 * x.c * x.d * c0 + x.d * x.d * v0 + x.velocity;
  out[8] = x.c * y.c * p1 + x.c * y.d * c1 + x.d * y.c * c2 + x.d * y.d * v1;
  out[9] = y.c * y.c * p2 + 2.0 * y.c * y.d * c3 + y.d * y.d * v2 + y.velocity;
}

/// Computes A Σ Aᵀ + W. `in` and `out` may be the same.
inline void predict(BlockLayout layout, const StepMotion& w, const double* in, double* out) {
  if (layout == BlockLayout::kPlanar) {
    out[0] = in[0] + w.position;
    out[1] = in[1];
    out[2] = in[2] + w.position;
    return;
  }
  if (layout == BlockLayout::kSpatial) {
    for (int i = 0; i < 6; ++i) {
      out[i] = in[i];
    }
    out[0] += w.position;
    out[3] += w.position;
    out[5] += w.position;
    return;
  }
  if (w.has_axis_motion) {
    predict_per_axis(w.x, w.y, in, out);
    return;
  }
  const double h = w.step_s;
  const double h2 = h * h;
  out[0] = in[0] + 2.0 * h * in[3] + h2 * in[7] + w.position;
  out[1] = in[1] + h * (in[4] + in[5]) + h2 * in[8];
  out[2] = in[2] + 2.0 * h * in[6] + h2 * in[9] + w.position;
  out[3] = in[3] + h * in[7] + w.cross;
  out[4] = in[4] + h * in[8];
  out[5] = in[5] + h * in[8];
  out[6] = in[6] + h * in[9] + w.cross;
  out[7] = in[7] + w.velocity;
  out[8] = in[8];
  out[9] = in[9] + w.velocity;
}

/// Returns det(I + M P) of a planar block: 1 + tr(M P) + det M det P.
inline double gain2(const double* m, const double* p) {
  return 1.0 + m[0] * p[0] + 2.0 * m[1] * p[1] + m[2] * p[2] +
         (m[0] * m[2] - m[1] * m[1]) * det2(p);
}

/// Computes (I + M P)⁻¹ M of a planar block, packed: (M + det M adj P) / det(I + M P).
inline void posterior_gain2(const double* m, const double* p, double* g) {
  const double det_m = m[0] * m[2] - m[1] * m[1];
  const double scale = 1.0 / gain2(m, p);
  g[0] = (m[0] + det_m * p[2]) * scale;
  g[1] = (m[1] - det_m * p[1]) * scale;
  g[2] = (m[2] + det_m * p[0]) * scale;
}

inline Eigen::Matrix3d unpack3(const double* p) {
  Eigen::Matrix3d full;
  full << p[0], p[1], p[2], p[1], p[3], p[4], p[2], p[4], p[5];
  return full;
}

inline void pack3(const Eigen::Matrix3d& full, double* p) {
  p[0] = full(0, 0);
  p[1] = 0.5 * (full(0, 1) + full(1, 0));
  p[2] = 0.5 * (full(0, 2) + full(2, 0));
  p[3] = full(1, 1);
  p[4] = 0.5 * (full(1, 2) + full(2, 1));
  p[5] = full(2, 2);
}

/// Returns the Cholesky factor of I + Lᵀ M L with P = L Lᵀ, spatial. The matrix is symmetric and ⪰
/// I for any precision of the measurement.
inline Eigen::LLT<Eigen::Matrix3d> whitened_gain3(const double* m, const Eigen::Matrix3d& L) {
  return Eigen::LLT<Eigen::Matrix3d>(Eigen::Matrix3d::Identity() + L.transpose() * unpack3(m) * L);
}

inline Eigen::Matrix4d unpack4(const double* p) {
  Eigen::Matrix4d full;
  full << p[0], p[1], p[3], p[4], p[1], p[2], p[5], p[6], p[3], p[5], p[7], p[8], p[4], p[6], p[8],
      p[9];
  return full;
}

/// Returns det(I + M Σ) for the block Σ of a moving target; M is packed in the same way as Σ.
double state_gain(const double* m, const double* b);
/// Computes (Σ⁻¹ + M)⁻¹ for the block Σ of a moving target; M is packed in the same way as Σ. `in`
/// and `out` may be the same.
void update_state(const double* m, const double* in, double* out);

/// Returns det(I + M P) for any layout.
inline double gain(BlockLayout layout, const double* m, const double* b) {
  if (layout == BlockLayout::kSpatial) {
    const Eigen::Matrix3d L = Eigen::LLT<Eigen::Matrix3d>(unpack3(b)).matrixL();
    const double root = whitened_gain3(m, L).matrixLLT().diagonal().prod();
    return root * root;
  }
  return gain2(m, b);
}

/// Computes (Σ⁻¹ + M)⁻¹. `in` and `out` may be the same.
inline void update(BlockLayout layout, const double* m, const double* in, double* out) {
  if (layout == BlockLayout::kSpatial) {
    // L (I + Lᵀ M L)⁻¹ Lᵀ contains no subtraction, so it stays positive definite.
    const Eigen::Matrix3d L = Eigen::LLT<Eigen::Matrix3d>(unpack3(in)).matrixL();
    const Eigen::Matrix3d X = whitened_gain3(m, L).matrixL().solve(L.transpose());
    pack3(X.transpose() * X, out);
    return;
  }
  double g[3];
  posterior_gain2(m, in, g);
  const double p0 = in[0];
  const double p1 = in[1];
  const double p2 = in[2];
  const double pg00 = p0 * g[0] + p1 * g[1];  // P G
  const double pg01 = p0 * g[1] + p1 * g[2];
  const double pg10 = p1 * g[0] + p2 * g[1];
  const double pg11 = p1 * g[1] + p2 * g[2];
  if (layout == BlockLayout::kMoving) {
    const double c0 = in[3];
    const double c1 = in[4];
    const double c2 = in[5];
    const double c3 = in[6];
    const double gc00 = g[0] * c0 + g[1] * c2;  // G C
    const double gc01 = g[0] * c1 + g[1] * c3;
    const double gc10 = g[1] * c0 + g[2] * c2;
    const double gc11 = g[1] * c1 + g[2] * c3;
    out[3] = c0 - (pg00 * c0 + pg01 * c2);
    out[4] = c1 - (pg00 * c1 + pg01 * c3);
    out[5] = c2 - (pg10 * c0 + pg11 * c2);
    out[6] = c3 - (pg10 * c1 + pg11 * c3);
    out[7] = in[7] - (c0 * gc00 + c2 * gc10);
    out[8] = in[8] - (c0 * gc01 + c2 * gc11);
    out[9] = in[9] - (c1 * gc01 + c3 * gc11);
  }
  out[0] = p0 - (pg00 * p0 + pg01 * p1);
  out[1] = p1 - (pg00 * p1 + pg01 * p2);
  out[2] = p2 - (pg10 * p1 + pg11 * p2);
}

/// A symmetric 2×2 matrix.
struct Square2 {
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
};

/// Returns P P + C Cᵀ of a planar or moving block.
inline Square2 squared_rows(BlockLayout layout, const double* b) {
  Square2 s{b[0] * b[0] + b[1] * b[1], b[0] * b[1] + b[1] * b[2], b[1] * b[1] + b[2] * b[2]};
  if (layout == BlockLayout::kMoving) {
    s.xx += b[3] * b[3] + b[4] * b[4];
    s.xy += b[3] * b[5] + b[4] * b[6];
    s.yy += b[5] * b[5] + b[6] * b[6];
  }
  return s;
}

/// Returns tr Σ − tr (Σ⁻¹ + M)⁻¹ = tr(G (P P + C Cᵀ)).
inline double trace_reduction(BlockLayout layout, const double* m, const double* b) {
  if (layout == BlockLayout::kSpatial) {
    double after[6];
    update(layout, m, b, after);
    return trace(layout, b) - trace(layout, after);
  }
  double g[3];
  posterior_gain2(m, b, g);
  const Square2 s = squared_rows(layout, b);
  return g[0] * s.xx + 2.0 * g[1] * s.xy + g[2] * s.yy;
}

/// As above, for information about the position or the state.
inline double gain(BlockLayout layout, const PackedInformation& M, const double* b) {
  return M.is_of_state ? state_gain(M.m, b) : gain(layout, M.m, b);
}
inline void update(BlockLayout layout, const PackedInformation& M, const double* in, double* out) {
  if (M.is_of_state) {
    update_state(M.m, in, out);
    return;
  }
  update(layout, M.m, in, out);
}
inline double trace_reduction(BlockLayout layout, const PackedInformation& M, const double* b) {
  if (M.is_of_state) {
    double after[kMaxPacked];
    update_state(M.m, b, after);
    return trace(layout, b) - trace(layout, after);
  }
  return trace_reduction(layout, M.m, b);
}

/// True only if a + εI − b is positive semidefinite. Uses Cholesky with a tolerance that can make
/// the result false but never wrongly true, so pruning by this test is safe.
bool dominates(BlockLayout layout, const double* a, double epsilon, const double* b);

}  // namespace vantage::planner
