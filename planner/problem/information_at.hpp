#pragma once

#include <span>

#include "models/sensor/sensor.hpp"
#include "models/world/world.hpp"

namespace vantage::planner {

/// Returns the information that all `sensors` together give about a target at `target_m`, measured
/// from `from`. Obstacles block the line of sight. The result is position_dim square, and zero if
/// no sensor sees the target. `world` may be null.
models::PositionMatrix information_at(const models::World* world,
                                      std::span<const models::SensorModel> sensors,
                                      const models::Viewpoint& from,
                                      const models::PositionVector& target_m);

/// As above, but about the state (position, velocity) of a target; the result has the size of the
/// state.
models::StateMatrix state_information_at(const models::World* world,
                                         std::span<const models::SensorModel> sensors,
                                         const models::Viewpoint& from,
                                         const models::StateVector& target);

}  // namespace vantage::planner
