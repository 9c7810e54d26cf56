#pragma once

#include <span>

#include "models/sensor/sensor.hpp"
#include "models/world/world.hpp"

namespace vantage::planner {

/// Information that all `sensors` give together of a target at `target_m` from `from`, nothing
/// through an obstacle; position_dim square, zero when nobody sees it. `world` may be null.
models::PositionMatrix look(const models::World* world,
                            std::span<const models::SensorModel> sensors,
                            const models::Viewpoint& from, const models::PositionVector& target_m);

}  // namespace vantage::planner
