#pragma once

#include <optional>

#include <Eigen/Core>

#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"

// One block of a block-diagonal belief. Targets are independent and each measurement is of one
// target, so the joint covariance stays block diagonal and is never formed. Planner and estimator
// call the same functions, so the covariance that a plan predicts is the one that the filter
// reports.

namespace vantage::models {

/// Gaussian N(mean, covariance) of one target's state.
struct Gaussian {
  StateVector mean;
  StateMatrix covariance;  ///< symmetric, positive definite
};

/// Gaussian in information form: matrix Ω = Σ⁻¹, vector ω = Ω y. Ω = 0 is complete ignorance.
struct Information {
  StateVector vector;
  StateMatrix matrix;
};

/// Converts between both forms; nullopt when the matrix is not positive definite (by Cholesky) or
/// its inverse is not finite. No allocation.
std::optional<Information> to_information(const Gaussian& belief);
std::optional<Gaussian> to_gaussian(const Information& belief);

/// Predicts the belief (ρᵖ): mean A y, covariance A Σ Aᵀ + W. No allocation.
Gaussian predict(const Gaussian& belief, const StateMatrix& A, const StateMatrix& W);
/// Predicts the belief over `dt_s` with A and W of `model`; the mean is c + A (y − c).
Gaussian predict(const Gaussian& belief, const TargetModel& model, double dt_s);
/// Predicts the belief of a target last seen `unseen_s` before the belief's time. Growing
/// uncertainty counts in steps of `step_s`; other models do not use `unseen_s`. Used by estimator
/// and planner alike.
Gaussian predict_unseen(const Gaussian& belief, const TargetModel& model, double dt_s,
                        double unseen_s, double step_s);
/// Predicts in information form: Ω ← (A Ω⁻¹ Aᵀ + W)⁻¹, ω ← Ω A ŷ; nullopt when Ω is singular.
std::optional<Information> predict(const Information& belief, const StateMatrix& A,
                                   const StateMatrix& W);

/// Updates the covariance (ρᵉ): (Σ⁻¹ + M)⁻¹ with M acting on the position components alone.
/// Computed as Σ − Σ_{:p} (I + M Σ_pp)⁻¹ M Σ_{p:}, symmetrised: works for singular M and never
/// inverts Σ.
StateMatrix update_covariance(const StateMatrix& covariance, const PositionMatrix& M);
/// Returns log det of the covariance by Cholesky; −∞ when it is singular.
double log_det(const StateMatrix& covariance);
/// Returns the differential entropy of the belief, ½ log det(2πe Σ), in nats.
double entropy_nats(const Gaussian& belief);

/// Fuses one linearised measurement: covariance by the Joseph form, mean by the Kalman gain. `H` is
/// z-dim × state-dim; the angles of `innovation` must be wrapped.
Gaussian update(const Gaussian& belief, const MeasurementJacobian& H, const MeasurementMatrix& V,
                const MeasurementVector& innovation);

}  // namespace vantage::models
