#include "models/target/kinds/kinds.hpp"

// A target that never moves: y' = y.

namespace vantage::models::target_kinds {

constinit const TargetLaw static_target{
    .name = "static",
    .is_constant = true,
    .process_noise = [](const TargetModel& model, double /*dt_s*/, int /*steps_unseen*/) {
      return StateMatrix(StateMatrix::Zero(model.dim(), model.dim()));
    }};

}  // namespace vantage::models::target_kinds
