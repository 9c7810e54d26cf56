#pragma once

#include <optional>

#include <Eigen/Core>

#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"

// One block of a block-diagonal belief. Targets are independent and each measurement is of one
// target, so the joint covariance stays block diagonal and is never formed. Planner and estimator
// call the same two functions, so the certainty that a plan promises is the one that the filter
// reports.

namespace vantage::models {

/// N(mean, covariance) of one target.
struct Gaussian {
  StateVector mean;
  StateMatrix covariance;  ///< symmetric, positive definite
};

/// The same in information form: matrix Ω = Σ⁻¹, vector ω = Ω y. Ω = 0 is complete ignorance.
struct Information {
  StateVector vector;
  StateMatrix matrix;
};

/// nullopt when the matrix cannot be inverted (not positive definite by Cholesky). No allocation.
std::optional<Information> to_information(const Gaussian& belief);
std::optional<Gaussian> to_gaussian(const Information& belief);

/// ρᵖ: mean A y, covariance A Σ Aᵀ + W. Allocates nothing.
Gaussian predict(const Gaussian& belief, const StateMatrix& A, const StateMatrix& W);
/// The same by a target's own A and W of `dt_s`, the mean as it expects: c + A (y − c).
Gaussian predict(const Gaussian& belief, const TargetModel& model, double dt_s);
/// The same of a target that was last seen `unseen_s` before the belief's instant, where growing
/// uncertainty counts in steps of `step_s`: what estimators and planners both go by.
Gaussian predict_unseen(const Gaussian& belief, const TargetModel& model, double dt_s,
                        double unseen_s, double step_s);
/// Ω ← (A Ω⁻¹ Aᵀ + W)⁻¹, ω ← Ω A ŷ; nullopt when Ω is singular.
std::optional<Information> predict(const Information& belief, const StateMatrix& A,
                                   const StateMatrix& W);

/// ρᵉ of the covariance: (Σ⁻¹ + M)⁻¹ with M acting on the position components alone.
/// Σ − Σ_{:p} (I + M Σ_pp)⁻¹ M Σ_{p:}, symmetrised; works for singular M, never inverts Σ.
StateMatrix update_covariance(const StateMatrix& covariance, const PositionMatrix& M);
/// log det of the covariance by Cholesky; −∞ when it is singular.
double log_det(const StateMatrix& covariance);
/// Differential entropy of the belief, ½ log det(2πe Σ), in nats.
double entropy_nats(const Gaussian& belief);

/// Fuses one measurement (already linearised): covariance by Joseph form, mean by the gain.
/// `H` is z-dim × state-dim, `innovation` has its angles wrapped.
Gaussian update(const Gaussian& belief, const MeasurementJacobian& H, const MeasurementMatrix& V,
                const MeasurementVector& innovation);

}  // namespace vantage::models
