#pragma once

#include "models/target/law.hpp"

// Motion models of the built-in target kinds, one file for each kind.

namespace vantage::models::target_kinds {

// The list of all motion models is in kinds.cpp.
extern const TargetLaw static_target;
extern const TargetLaw random_walk;
extern const TargetLaw double_integrator;
extern const TargetLaw growing_uncertainty;
extern const TargetLaw damped_oscillator;

}  // namespace vantage::models::target_kinds
