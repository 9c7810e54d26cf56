#include "planner/search/linearised_cost.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace vantage::planner {
namespace {

// Returns λ_max of the position covariance.
double widest(const double* packed) {
  const double half = 0.5 * (packed[0] + packed[2]);
  const double difference = 0.5 * (packed[0] - packed[2]);
  return half + std::sqrt(difference * difference + packed[1] * packed[1]);
}

}  // namespace

LinearisedCost::LinearisedCost(int targets_max, int horizon_max) {
  const std::size_t looks = index(targets_max) * index(horizon_max);
  gradients_.resize(looks);
  known_.resize(looks);
  reached_.resize(looks);
  covariances_.resize(index(horizon_max + 1));
  predicted_.resize(index(horizon_max + 1));
}

void LinearisedCost::reset(const SearchProblem& problem, const BeliefTable& beliefs,
                           InformationMeasure measure) {
  problem_ = &problem;
  beliefs_ = &beliefs;
  measure_ = measure;
  targets_ = beliefs.target_count();
  horizon_ = problem.horizon_steps;
}

void LinearisedCost::clear_reached() {
  std::fill_n(reached_.begin(), index(targets_) * index(horizon_), std::uint8_t{0});
}

double LinearisedCost::linearise(int m, int depth, const double* block, const float* reference) {
  return beliefs_->layout(m) == BlockLayout::kPlanar
             ? linearise_block<2>(m, depth, block, reference)
             : linearise_block<4>(m, depth, block, reference);
}

// Long function: its forward pass stores the values that its backward pass needs.
template <int kDim>
double LinearisedCost::linearise_block(int m, int depth, const double* block,
                                       const float* reference) {
  using Matrix = Eigen::Matrix<double, kDim, kDim>;
  const bool is_mutual = measure_ == InformationMeasure::kMutual;
  const BlockLayout layout = beliefs_->layout(m);
  double packed[kMaxPacked];
  double unseen[kMaxPacked];
  std::copy_n(block, packed_size(layout), packed);
  std::copy_n(block, packed_size(layout), unseen);
  double cost = 0.0;
  bool any = false;
  // Forward: covariances at the reference, and their cost.
  for (int k = depth + 1; k <= horizon_; ++k) {
    any = any || is_reached(m, k);
    beliefs_->predict_into(m, k, packed, packed);
    beliefs_->predict_into(m, k, unseen, unseen);
    known_[at(m, k)] = 1.0 / widest(unseen);
    if (is_mutual) {
      predicted_[index(k)].topLeftCorner<kDim, kDim>() = unpack(layout, packed);
      cost -= std::log(determinant(layout, packed));
    }
    if (is_reached(m, k)) {
      PackedInformation M;
      std::copy_n(reference + 3 * at(m, k), 3, M.m);
      update(layout, M.m, packed, packed);
    }
    covariances_[index(k)].topLeftCorner<kDim, kDim>() = unpack(layout, packed);
    cost += std::log(determinant(layout, packed));
  }
  if (!any) {
    return cost;
  }
  // Backward: L = ∂J/∂Σ at each depth.
  const Matrix A = problem_->targets[index(m)].model.transition(problem_->step_s);
  Matrix L = Matrix::Zero();
  for (int k = horizon_; k > depth; --k) {
    const Matrix Sigma = covariances_[index(k)].topLeftCorner<kDim, kDim>();
    L += Sigma.inverse();
    const Eigen::Matrix2d G = (Sigma * L * Sigma).template topLeftCorner<2, 2>();
    Gradient& gradient = gradients_[at(m, k)];
    gradient = {G(0, 0), 0.5 * (G(0, 1) + G(1, 0)), G(1, 1)};
    const float* const R = reference + 3 * at(m, k);
    Eigen::Matrix2d M = Eigen::Matrix2d::Zero();
    if (is_reached(m, k)) {
      M << R[0], R[1], R[1], R[2];
      cost += gradient.xx * M(0, 0) + 2.0 * gradient.xy * M(0, 1) + gradient.yy * M(1, 1);
    }
    if (!problem_->fixed_information.empty()) {
      const models::StateMatrix& fixed = problem_->fixed_information[index(m)][index(k - 1)];
      if (fixed.size() > 0) {
        M += fixed;
      }
    }
    Matrix K = Matrix::Identity();  // Σ Σₚ⁻¹
    K.template leftCols<2>() -= Sigma.template leftCols<2>() * M;
    if (is_mutual) {
      const Matrix predicted = predicted_[index(k)].topLeftCorner<kDim, kDim>();
      L = (K.transpose() * L * K - Matrix(predicted.inverse())).eval();
      L = (A.transpose() * L * A).eval();
    } else {
      const Matrix KA = K * A;
      L = (KA.transpose() * L * KA).eval();
    }
  }
  return cost;
}

}  // namespace vantage::planner
