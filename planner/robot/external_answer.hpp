#pragma once

#include <optional>

#include "models/exchange/messages.hpp"
#include "models/motion/vehicle_limits.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Returns the motion in an external planner's `answer`, adapted for flight. The motion starts
/// exactly at the start of `committed` and ends in a hover. A missing stop is added with the
/// vehicle's brake deceleration.
///
/// Returns nullopt for an invalid plan of this slot. Its start must have the right time and height,
/// and be within 1 mm and 1 mrad of the committed start. It may drive or brake for at most the
/// horizon. The number of segments is limited to the steps of four horizons and to the drivers'
/// limit (but one horizon is always allowed). A segment must have a positive duration, move forward
/// within the vehicle's limits, and not turn while braking. Walls and teammates are not checked.
std::optional<models::Trajectory> motion_of_answer(const models::RobotPlan& answer,
                                                   const models::Trajectory& committed,
                                                   const scenario::PlannerSpec& planner,
                                                   const models::VehicleLimits& limits);

}  // namespace vantage::planner
