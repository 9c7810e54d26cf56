#include "planner/problem/block_kernels.hpp"

#include <algorithm>
#include <iterator>

namespace vantage::planner {
namespace {

// Computes the lower triangle of the symmetric matrix a + εI − b and returns its number of rows.
int difference(BlockLayout layout, const double* a, double epsilon, const double* b,
               double (&d)[4][4]) {
  if (layout == BlockLayout::kMoving) {
    const double p0 = a[0] - b[0];
    const double p1 = a[1] - b[1];
    const double p2 = a[2] - b[2];
    const double v0 = a[7] - b[7];
    const double v1 = a[8] - b[8];
    const double v2 = a[9] - b[9];
    d[0][0] = p0 + epsilon;
    d[1][0] = p1;
    d[1][1] = p2 + epsilon;
    d[2][0] = a[3] - b[3];
    d[3][0] = a[4] - b[4];
    d[2][1] = a[5] - b[5];
    d[3][1] = a[6] - b[6];
    d[2][2] = v0 + epsilon;
    d[3][2] = v1;
    d[3][3] = v2 + epsilon;
    return 4;
  }
  d[0][0] = a[0] - b[0] + epsilon;
  d[1][0] = a[1] - b[1];
  if (layout == BlockLayout::kPlanar) {
    d[1][1] = a[2] - b[2] + epsilon;
    return 2;
  }
  d[2][0] = a[2] - b[2];
  d[1][1] = a[3] - b[3] + epsilon;
  d[2][1] = a[4] - b[4];
  d[2][2] = a[5] - b[5] + epsilon;
  return 3;
}

// Returns the Cholesky factor of I + Lᵀ M L with Σ = L Lᵀ.
Eigen::LLT<Eigen::Matrix4d> whitened_gain4(const double* m, const Eigen::Matrix4d& L) {
  return Eigen::LLT<Eigen::Matrix4d>(Eigen::Matrix4d::Identity() + L.transpose() * unpack4(m) * L);
}

}  // namespace

double state_gain(const double* m, const double* b) {
  const Eigen::Matrix4d L = Eigen::LLT<Eigen::Matrix4d>(unpack4(b)).matrixL();
  const double root = whitened_gain4(m, L).matrixLLT().diagonal().prod();
  return root * root;
}

void update_state(const double* m, const double* in, double* out) {
  const Eigen::Matrix4d L = Eigen::LLT<Eigen::Matrix4d>(unpack4(in)).matrixL();
  const Eigen::Matrix4d X = whitened_gain4(m, L).matrixL().solve(L.transpose());
  const Eigen::Matrix4d S = X.transpose() * X;
  const double packed[] = {S(0, 0), S(0, 1), S(1, 1), S(0, 2), S(0, 3),
                           S(1, 2), S(1, 3), S(2, 2), S(2, 3), S(3, 3)};
  std::copy(std::begin(packed), std::end(packed), out);
}

StepMotion step_motion(const models::TargetModel& model, double step_s) {
  const models::StateMatrix W = model.process_noise(step_s);
  StepMotion motion;
  motion.step_s = step_s;
  motion.position = W(0, 0);
  if (model.has_velocity()) {
    motion.cross = W(0, 2);
    motion.velocity = W(2, 2);
    const models::StateMatrix A = model.transition(step_s);
    motion.x = {A(0, 0), A(0, 2), A(2, 0), A(2, 2), W(0, 0), W(0, 2), W(2, 2)};
    motion.y = {A(1, 1), A(1, 3), A(3, 1), A(3, 3), W(1, 1), W(1, 3), W(3, 3)};
    const AxisMotion free{1.0, step_s, 0.0, 1.0, W(0, 0), W(0, 2), W(2, 2)};
    motion.has_axis_motion = motion.x != free || motion.y != free;
  }
  return motion;
}

bool dominates(BlockLayout layout, const double* a, double epsilon, const double* b) {
  double d[4][4];
  const int n = difference(layout, a, epsilon, b, d);
  for (int i = 0; i < n; ++i) {  // cheapest test first: the diagonal
    if (!(d[i][i] >= 0.0)) {
      return false;
    }
  }
  const double magnitude = trace(layout, a) + trace(layout, b) + epsilon;
  // Cholesky. A pivot must exceed its rounding error, or be exactly zero together with its column
  // (if two blocks share entries). Only then is the result certain.
  constexpr double kRounding = 1e-14;
  for (int j = 0; j < n; ++j) {
    const double scale = d[j][j];
    double pivot = scale;
    for (int k = 0; k < j; ++k) {
      pivot -= d[j][k] * d[j][k];
    }
    const bool exact_zero = scale == 0.0 && pivot == 0.0;
    if (!exact_zero && !(pivot > kRounding * (scale + magnitude))) {
      return false;
    }
    const double root = exact_zero ? 0.0 : std::sqrt(pivot);
    for (int i = j + 1; i < n; ++i) {
      double below = d[i][j];
      for (int k = 0; k < j; ++k) {
        below -= d[i][k] * d[j][k];
      }
      if (root > 0.0) {
        d[i][j] = below / root;
      } else if (below == 0.0) {
        d[i][j] = 0.0;
      } else {
        return false;
      }
    }
  }
  return true;
}

}  // namespace vantage::planner
