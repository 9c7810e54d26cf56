#include "planner/problem/block_kernels.hpp"

namespace vantage::planner {
namespace {

// Unpacks a + εI − b into a full symmetric matrix of `n` rows; returns n.
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

}  // namespace

bool dominates(BlockLayout layout, const double* a, double epsilon, const double* b) {
  double d[4][4];
  const int n = difference(layout, a, epsilon, b, d);
  for (int i = 0; i < n; ++i) {  // cheapest first: the diagonal
    if (!(d[i][i] >= 0.0)) {
      return false;
    }
  }
  const double magnitude = trace(layout, a) + trace(layout, b) + epsilon;
  // Cholesky. A pivot has to clear its own rounding error, or be exactly zero with all of its
  // column (as where two blocks share entries): then and only then is the answer certain.
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
