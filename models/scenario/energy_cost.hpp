#pragma once

#include <Eigen/Core>

#include "models/motion/unicycle.hpp"
#include "models/scenario/energy_spec.hpp"
#include "models/world/world.hpp"

namespace vantage::models {

/// c_ctrl(u) + c_state(x): what a step of `control` that begins at `at_m` costs, without its price.
/// `world` may be null: no regions.
double step_cost(const EnergySpec& energy, const World* world, const UnicycleControl& control,
                 const Eigen::Vector2d& at_m);

}  // namespace vantage::models
