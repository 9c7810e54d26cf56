#pragma once

#include <optional>

#include "models/exchange/messages.hpp"
#include "models/motion/vehicle_limits.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Returns the motion in an external planner's `answer`, adapted for flight. It starts exactly
/// where `committed` does and ends in a hover; a missing stop is added with the vehicle's limits.
///
/// Returns nullopt for an invalid plan of this slot: one that starts at another time, farther than
/// 1 mm or 1 mrad away, or at another height; that drives or brakes for longer than the horizon;
/// that has more segments than four horizons have steps, or than drivers fly (but a horizon's worth
/// is always allowed); or with a segment of no duration, backwards, beyond the vehicle's limits, or
/// turning while braking. Does not check walls and teammates.
std::optional<models::Trajectory> motion_of_answer(const models::RobotPlan& answer,
                                                   const models::Trajectory& committed,
                                                   const scenario::PlannerSpec& planner,
                                                   const models::VehicleLimits& limits);

}  // namespace vantage::planner
