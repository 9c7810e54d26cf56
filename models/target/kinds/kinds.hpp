#pragma once

#include "models/target/law.hpp"

// The laws of the built-in target models, one file for each model.

namespace vantage::models::target_kinds {

// The list of all laws is in kinds.cpp.
extern const TargetLaw static_target;
extern const TargetLaw random_walk;
extern const TargetLaw double_integrator;
extern const TargetLaw growing_uncertainty;
extern const TargetLaw damped_oscillator;

}  // namespace vantage::models::target_kinds
