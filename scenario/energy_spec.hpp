#pragma once

#include <string>
#include <vector>

namespace vantage::scenario {

/// What moving costs a robot, C_i = Σ_{t=0}^{T−1} (c_ctrl(u_t) + c_state(x_t)), and its price.
/// Source: dissertation eq. 3.14, 3.19, Table 3.1.
struct EnergySpec {
  double price_nats = 0.0;           ///< r_i: nats of information that one unit of cost is worth
  double rest_cost = 0.0;            ///< a step with neither speed nor yaw rate
  double turn_cost = 0.0;            ///< a step with a yaw rate alone
  double move_cost = 0.0;            ///< any step with a speed
  std::vector<std::string> regions;  ///< names of the world's regions whose cost_per_step it pays
};

}  // namespace vantage::scenario
