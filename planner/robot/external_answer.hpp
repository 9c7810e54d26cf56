#pragma once

#include <optional>

#include "models/exchange/messages.hpp"
#include "models/motion/vehicle_limits.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// The motion that another process's `answer` gives a robot, as it may be flown: from where
/// `committed` begins, to the bit, to a hover; a stop that the answer lacks is the vehicle's own.
///
/// nullopt for what is no plan of this slot: it begins at another time, or farther than 1 mm or
/// 1 mrad from there, or at another height; it drives for longer than the horizon (and its stop) or
/// in more segments than four horizons have steps, or than the horizon's and than drivers fly; a
/// segment without length, backwards, beyond the vehicle's limits, or turning while it brakes.
/// Whether the motion is clear of walls and teammates is not asked here.
std::optional<models::Trajectory> motion_of_answer(const models::RobotPlan& answer,
                                                   const models::Trajectory& committed,
                                                   const scenario::PlannerSpec& planner,
                                                   const models::VehicleLimits& limits);

}  // namespace vantage::planner
