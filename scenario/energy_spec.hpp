#pragma once

#include <string>
#include <vector>

namespace vantage::scenario {

/// Cost of a robot's motion, C_i = Σ_{t=0}^{T−1} (c_ctrl(u_t) + c_state(x_t)), and its weight
/// against information.
/// Source: dissertation eq. 3.14, 3.19, Table 3.1.
struct EnergySpec {
  double price_nats = 0.0;           ///< r_i; nats per unit of motion cost
  double rest_cost = 0.0;            ///< cost of a step with zero speed and yaw rate
  double turn_cost = 0.0;            ///< cost of a step with yaw rate but zero speed
  double move_cost = 0.0;            ///< cost of a step with nonzero speed
  std::vector<std::string> regions;  ///< names of regions that add their cost_per_step
};

}  // namespace vantage::scenario
