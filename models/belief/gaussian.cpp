#include "models/belief/gaussian.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/angle.hpp"
#include "models/target/law.hpp"

// P, N, Z: numbers of rows of the position, the state and the measurement. All matrices have a
// maximum size that is known at compile time, so they do not use the heap.

namespace vantage::models {
namespace {

StateMatrix symmetrised(const StateMatrix& X) { return 0.5 * (X + X.transpose()); }

std::optional<StateMatrix> inverse_spd(const StateMatrix& X) {
  const Eigen::LLT<StateMatrix> cholesky(X);
  if (cholesky.info() != Eigen::Success) {
    return std::nullopt;
  }
  const StateMatrix inverse = cholesky.solve(StateMatrix::Identity(X.rows(), X.cols()));
  if (!inverse.allFinite()) {
    return std::nullopt;
  }
  return symmetrised(inverse);
}

// Computes the formula of update_covariance() with fixed sizes, so that the compiler unrolls loops.
template <int N, int P>
StateMatrix update_fixed(const StateMatrix& covariance, const PositionMatrix& M_position) {
  const Eigen::Matrix<double, N, N> S = covariance;
  const Eigen::Matrix<double, P, P> M = M_position;
  const Eigen::Matrix<double, P, P> I_MS =
      Eigen::Matrix<double, P, P>::Identity() + M * S.template topLeftCorner<P, P>();
  Eigen::Matrix<double, P, P> gain;
  if constexpr (P == 2) {
    gain = I_MS.inverse() * M;
  } else {  // 3×3 cofactors lose four digits when M is large and nearly singular
    gain = I_MS.partialPivLu().solve(M);
  }
  const Eigen::Matrix<double, N, N> updated =
      S - S.template leftCols<P>() * gain * S.template topRows<P>();
  return 0.5 * (updated + updated.transpose());
}

}  // namespace

std::optional<Information> to_information(const Gaussian& belief) {
  const std::optional<StateMatrix> Omega = inverse_spd(belief.covariance);
  if (!Omega) {
    return std::nullopt;
  }
  return Information{*Omega * belief.mean, *Omega};
}

std::optional<Gaussian> to_gaussian(const Information& belief) {
  const std::optional<StateMatrix> Sigma = inverse_spd(belief.matrix);
  if (!Sigma) {
    return std::nullopt;
  }
  return Gaussian{*Sigma * belief.vector, *Sigma};
}

Gaussian predict(const Gaussian& belief, const StateMatrix& A, const StateMatrix& W) {
  const StateMatrix A_Sigma = A * belief.covariance;
  const StateMatrix predicted = A_Sigma * A.transpose() + W;
  return {A * belief.mean, symmetrised(predicted)};
}

Gaussian predict(const Gaussian& belief, const TargetModel& model, double dt_s) {
  Gaussian predicted = predict(belief, model.transition(dt_s), model.process_noise(dt_s));
  if (model.kind.law().center_m != nullptr) {
    predicted.mean = model.expected(belief.mean, dt_s);
  }
  return predicted;
}

Gaussian predict_unseen(const Gaussian& belief, const TargetModel& model, double dt_s,
                        double unseen_s, double step_s) {
  if (model.kind.law().unseen_noise == nullptr) {
    return predict(belief, model, dt_s);
  }
  return predict(belief, model.transition(dt_s),
                 model.grown_noise(unseen_s / step_s, (unseen_s + dt_s) / step_s));
}

std::optional<Information> predict(const Information& belief, const StateMatrix& A,
                                   const StateMatrix& W) {
  const std::optional<Gaussian> gaussian = to_gaussian(belief);
  if (!gaussian) {
    return std::nullopt;
  }
  return to_information(predict(*gaussian, A, W));
}

StateMatrix update_covariance(const StateMatrix& covariance, const PositionMatrix& M) {
  const Eigen::Index n = covariance.rows();
  const Eigen::Index p = M.rows();
  if (n == 2 && p == 2) {
    return update_fixed<2, 2>(covariance, M);
  }
  if (n == 4 && p == 2) {
    return update_fixed<4, 2>(covariance, M);
  }
  if (n == 3 && p == 3) {
    return update_fixed<3, 3>(covariance, M);
  }
  const PositionMatrix M_Spp = M * covariance.topLeftCorner(p, p);
  const PositionMatrix I_MS = PositionMatrix::Identity(p, p) + M_Spp;
  const PositionMatrix gain = I_MS.partialPivLu().solve(M);
  const MeasurementJacobian gain_S = gain * covariance.topRows(p);
  const StateMatrix reduction = covariance.leftCols(p) * gain_S;
  return symmetrised(covariance - reduction);
}

StateMatrix update_state_covariance(const StateMatrix& covariance, const StateMatrix& M) {
  const Eigen::Index n = covariance.rows();
  const StateMatrix I_MS = StateMatrix::Identity(n, n) + M * covariance;
  const StateMatrix gain = I_MS.partialPivLu().solve(M);
  const StateMatrix reduction = covariance * gain * covariance;
  const StateMatrix updated = covariance - reduction;
  return 0.5 * (updated + updated.transpose());
}

double log_det(const StateMatrix& covariance) {
  const Eigen::LLT<StateMatrix> cholesky(covariance);
  if (cholesky.info() != Eigen::Success) {
    return -std::numeric_limits<double>::infinity();
  }
  double sum = 0.0;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    sum += std::log(cholesky.matrixLLT()(i, i));
  }
  return 2.0 * sum;
}

double entropy_nats(const Gaussian& belief) {
  const double n = static_cast<double>(belief.covariance.rows());
  return 0.5 * (n * std::log(2.0 * kPi * std::exp(1.0)) + log_det(belief.covariance));
}

Gaussian update(const Gaussian& belief, const MeasurementJacobian& H, const MeasurementMatrix& V,
                const MeasurementVector& innovation) {
  using Gain = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxTargetDim,
                             kMaxMeasurementDim>;
  const Eigen::Index n = belief.covariance.rows();
  const MeasurementJacobian H_Sigma = H * belief.covariance;
  const MeasurementMatrix S = H_Sigma * H.transpose() + V;
  const MeasurementJacobian K_transposed = Eigen::LLT<MeasurementMatrix>(S).solve(H_Sigma);
  const Gain K = K_transposed.transpose();
  const StateMatrix I_KH = StateMatrix::Identity(n, n) - K * H;
  const StateMatrix I_KH_Sigma = I_KH * belief.covariance;
  const Gain K_V = K * V;
  const StateMatrix joseph = I_KH_Sigma * I_KH.transpose() + K_V * K.transpose();
  return {belief.mean + K * innovation, symmetrised(joseph)};
}

}  // namespace vantage::models
