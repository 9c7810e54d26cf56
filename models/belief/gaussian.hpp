#pragma once

#include <optional>

#include <Eigen/Core>

#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"

// One block of a block-diagonal belief. Targets are independent, and each measurement concerns one
// target. The joint covariance therefore stays block diagonal and is never formed. Planner and
// estimator call the same predict and update functions, so a plan predicts the uncertainty that the
// filter computes.

namespace vantage::models {

/// Gaussian N(mean, covariance) of one target's state.
struct Gaussian {
  StateVector mean;
  StateMatrix covariance;  ///< symmetric, positive definite
};

/// A Gaussian belief in information form: matrix Ω = Σ⁻¹, vector ω = Ω y. Ω = 0: no information.
struct Information {
  StateVector vector;
  StateMatrix matrix;
};

/// Convert between covariance and information form; nullopt if the matrix cannot be inverted (not
/// positive definite by Cholesky). These functions do not allocate.
std::optional<Information> to_information(const Gaussian& belief);
std::optional<Gaussian> to_gaussian(const Information& belief);

/// Returns the prediction ρᵖ: mean A y, covariance A Σ Aᵀ + W. Does not allocate.
Gaussian predict(const Gaussian& belief, const StateMatrix& A, const StateMatrix& W);
/// Returns the prediction with the model's A and W for `dt_s`; the mean is c + A (y − c).
Gaussian predict(const Gaussian& belief, const TargetModel& model, double dt_s);
/// As predict() with a model, for a target that was last seen `unseen_s` before the time of the
/// belief. Models with growing uncertainty count the unseen time in steps of `step_s`. Estimators
/// and planners both use this function.
Gaussian predict_unseen(const Gaussian& belief, const TargetModel& model, double dt_s,
                        double unseen_s, double step_s);
/// Returns the prediction: matrix (A Ω⁻¹ Aᵀ + W)⁻¹, and the vector that belongs to the mean A ŷ;
/// nullopt when Ω is singular.
std::optional<Information> predict(const Information& belief, const StateMatrix& A,
                                   const StateMatrix& W);

/// Returns the measurement update ρᵉ of the covariance: (Σ⁻¹ + M)⁻¹, where M acts on the position
/// components only. Computed as Σ − Σ_{:p} (I + M Σ_pp)⁻¹ M Σ_{p:}, symmetrised. Works for singular
/// M and never inverts Σ.
StateMatrix update_covariance(const StateMatrix& covariance, const PositionMatrix& M);
/// As update_covariance(), but M is about the whole state and has the size of `covariance`.
StateMatrix update_state_covariance(const StateMatrix& covariance, const StateMatrix& M);
/// Returns log det of the covariance by Cholesky; −∞ when it is singular.
double log_det(const StateMatrix& covariance);
/// Returns the differential entropy of the belief, ½ log det(2πe Σ), nats.
double entropy_nats(const Gaussian& belief);

/// Fuses one linearised measurement: covariance by the Joseph form, mean by the Kalman gain. `H` is
/// z-dim × state-dim; the angles of `innovation` must be wrapped.
Gaussian update(const Gaussian& belief, const MeasurementJacobian& H, const MeasurementMatrix& V,
                const MeasurementVector& innovation);

}  // namespace vantage::models
