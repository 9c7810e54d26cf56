#include "models/target/kinds/kinds.hpp"

// White acceleration of density q, m²/s³, on each axis; state (y₁, y₂, ẏ₁, ẏ₂).
// Source: dissertation, section 2.H.

namespace vantage::models::target_kinds {

constinit const TargetLaw double_integrator{
    .name = "double_integrator",
    .has_velocity = true,
    .uses_q = true,
    .transition =
        [](const TargetModel& /*model*/, double dt_s) {
          StateMatrix A = StateMatrix::Identity(4, 4);
          A(0, 2) = dt_s;
          A(1, 3) = dt_s;
          return A;
        },
    .process_noise =
        [](const TargetModel& model, double dt_s, int /*steps_unseen*/) {
          const double q = model.q;
          StateMatrix W = StateMatrix::Zero(4, 4);
          W.diagonal().head(2).setConstant(q * dt_s * dt_s * dt_s / 3.0);
          W.diagonal().tail(2).setConstant(q * dt_s);
          W.topRightCorner(2, 2).diagonal().setConstant(q * dt_s * dt_s / 2.0);
          W.bottomLeftCorner(2, 2).diagonal().setConstant(q * dt_s * dt_s / 2.0);
          return W;
        }};

}  // namespace vantage::models::target_kinds
