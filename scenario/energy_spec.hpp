#pragma once

#include <string>
#include <vector>

namespace vantage::scenario {

/// Cost of a robot's motion, C_i = Σ_{t=0}^{T−1} (c_ctrl(u_t) + c_state(x_t)), and its price.
/// Source: dissertation eq. 3.14, 3.19, Table 3.1.
struct EnergySpec {
  double price_nats = 0.0;           ///< r_i: nats of information per unit of cost
  double rest_cost = 0.0;            ///< per step without speed and yaw rate
  double turn_cost = 0.0;            ///< per step with a yaw rate only
  double move_cost = 0.0;            ///< per step with a speed
  std::vector<std::string> regions;  ///< names of the regions whose cost_per_step it pays
};

}  // namespace vantage::scenario
