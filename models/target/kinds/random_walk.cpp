#include "models/target/kinds/kinds.hpp"

// White velocity of density q, m²/s: y' = y + w, W = qτ I.

namespace vantage::models::target_kinds {

constinit const TargetLaw random_walk{
    .name = "random_walk",
    .uses_q = true,
    .process_noise = [](const TargetModel& model, double dt_s, int /*steps_unseen*/) {
      return StateMatrix(model.q * dt_s * StateMatrix::Identity(model.dim(), model.dim()));
    }};

}  // namespace vantage::models::target_kinds
