#include "scenario/energy_cost.hpp"

#include <algorithm>

namespace vantage::scenario {

double step_cost(const EnergySpec& energy, const models::World* world,
                 const models::UnicycleControl& control, const Eigen::Vector2d& at_m) {
  double cost = control.speed_mps != 0.0        ? energy.move_cost
                : control.yaw_rate_radps != 0.0 ? energy.turn_cost
                                                : energy.rest_cost;
  if (world != nullptr) {
    for (const models::Region& region : world->regions) {
      const bool pays = std::find(energy.regions.begin(), energy.regions.end(), region.name) !=
                        energy.regions.end();
      cost += pays && region.footprint.contains(at_m) ? region.cost_per_step : 0.0;
    }
  }
  return cost;
}

}  // namespace vantage::scenario
