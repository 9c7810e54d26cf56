#pragma once

#include <cmath>

#include "models/target/law.hpp"

// A target model that is not in the library, as a user would write it: a body with white
// acceleration of density q, m²/s³, whose velocity decays by linear drag.

namespace vantage::test {

inline constexpr double kDrag_per_s = 0.4;

inline const models::TargetLaw& drag_law() {
  using models::StateMatrix;
  using models::TargetModel;
  static constexpr models::TargetLaw kLaw{
      .name = "drag",
      .has_velocity = true,
      .uses_q = true,
      .transition =
          [](const TargetModel& /*model*/, double dt_s) {
            const double decay = std::exp(-kDrag_per_s * dt_s);
            StateMatrix A = StateMatrix::Identity(4, 4);
            A.diagonal().tail(2).setConstant(decay);
            A.topRightCorner(2, 2).diagonal().setConstant((1.0 - decay) / kDrag_per_s);
            return A;
          },
      .process_noise =
          [](const TargetModel& model, double dt_s, int /*steps_unseen*/) {
            const double lost = 1.0 - std::exp(-kDrag_per_s * dt_s);
            const double lost_twice = 1.0 - std::exp(-2.0 * kDrag_per_s * dt_s);
            const double q = model.q / (kDrag_per_s * kDrag_per_s);
            StateMatrix W = StateMatrix::Zero(4, 4);
            W.diagonal().head(2).setConstant(
                q * (dt_s - 2.0 * lost / kDrag_per_s + 0.5 * lost_twice / kDrag_per_s));
            W.diagonal().tail(2).setConstant(0.5 * q * kDrag_per_s * lost_twice);
            W.topRightCorner(2, 2).diagonal().setConstant(0.5 * q * lost * lost);
            W.bottomLeftCorner(2, 2).diagonal().setConstant(0.5 * q * lost * lost);
            return W;
          },
  };
  return kLaw;
}

/// Returns the handle of the target kind.
inline models::TargetKind drag() { return models::TargetKind(drag_law()); }

}  // namespace vantage::test
