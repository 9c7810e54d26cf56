#pragma once

#include <Eigen/Core>

#include "models/motion/unicycle.hpp"
#include "models/world/world.hpp"
#include "scenario/energy_spec.hpp"

namespace vantage::scenario {

/// Returns c_ctrl(u) + c_state(x), the motion cost of a step with `control` that begins at `at_m`,
/// not multiplied by price_nats. A null `world` has no regions.
double step_cost(const EnergySpec& energy, const models::World* world,
                 const models::UnicycleControl& control, const Eigen::Vector2d& at_m);

}  // namespace vantage::scenario
