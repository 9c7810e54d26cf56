#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "planner/search/lattice_bound.hpp"

// J at the reference and its gradient there.

namespace vantage::planner {
namespace {

// λ_max of the position's covariance.
double widest(const double* packed) {
  const double half = 0.5 * (packed[0] + packed[2]);
  const double difference = 0.5 * (packed[0] - packed[2]);
  return half + std::sqrt(difference * difference + packed[1] * packed[1]);
}

}  // namespace

template <int kDim>
double LatticeBound::linearise(int m, const double* block, float* reference) {
  using Matrix = Eigen::Matrix<double, kDim, kDim>;
  const BlockLayout layout = beliefs_->layout(m);
  double packed[kMaxPacked];
  double unseen[kMaxPacked];
  std::copy_n(block, packed_size(layout), packed);
  std::copy_n(block, packed_size(layout), unseen);
  double cost = 0.0;
  bool any = false;
  // Forwards: the covariances at the reference, and what they cost.
  for (int k = depth_ + 1; k <= horizon_; ++k) {
    float* const R = reference + 3 * at(m, k);
    const bool reached = in_reach(m, k);
    reached_[at(m, k)] = reached ? 1 : 0;
    any = any || reached;
    beliefs_->predict_into(m, k, packed, packed);
    beliefs_->predict_into(m, k, unseen, unseen);
    known_[at(m, k)] = 1.0 / widest(unseen);
    if (reached) {
      PackedInformation M;
      std::copy_n(R, 3, M.m);
      update(layout, M.m, packed, packed);
    }
    covariances_[index(k)].topLeftCorner<kDim, kDim>() = unpack(layout, packed);
    cost += std::log(determinant(layout, packed));
  }
  if (!any) {
    return cost;
  }
  // Backwards: L = ∂J/∂Σ at each depth.
  const Matrix A = problem_->targets[index(m)].model.transition(problem_->step_s);
  Matrix L = Matrix::Zero();
  for (int k = horizon_; k > depth_; --k) {
    const Matrix Sigma = covariances_[index(k)].topLeftCorner<kDim, kDim>();
    L += Sigma.inverse();
    const Eigen::Matrix2d G = (Sigma * L * Sigma).template topLeftCorner<2, 2>();
    Gradient& gradient = gradients_[at(m, k)];
    gradient = {G(0, 0), 0.5 * (G(0, 1) + G(1, 0)), G(1, 1)};
    const float* const R = reference + 3 * at(m, k);
    Eigen::Matrix2d M = Eigen::Matrix2d::Zero();
    if (reached_[at(m, k)] != 0) {
      M << R[0], R[1], R[1], R[2];
      cost += gradient.xx * M(0, 0) + 2.0 * gradient.xy * M(0, 1) + gradient.yy * M(1, 1);
    }
    if (!problem_->fixed_information.empty()) {
      const models::PositionMatrix& fixed = problem_->fixed_information[index(m)][index(k - 1)];
      if (fixed.size() > 0) {
        M += fixed;
      }
    }
    Matrix K = Matrix::Identity();  // Σ Σₚ⁻¹
    K.template leftCols<2>() -= Sigma.template leftCols<2>() * M;
    const Matrix KA = K * A;
    L = (KA.transpose() * L * KA).eval();
  }
  return cost;
}

template double LatticeBound::linearise<2>(int, const double*, float*);
template double LatticeBound::linearise<4>(int, const double*, float*);

}  // namespace vantage::planner
