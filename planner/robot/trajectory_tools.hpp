#pragma once

#include <vector>

#include "models/plan/plan.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Returns the part of `trajectory` from `start` on, as a trajectory that starts then; the same
/// motion to rounding. Precondition: start ≥ trajectory.start_time, otherwise the wait is lost.
models::Trajectory rest_of(const models::Trajectory& trajectory, Time start);

/// Returns a stop that starts at once from the state of `trajectory` at `start`, then hovers.
models::Trajectory stop_from(const models::Trajectory& trajectory, Time start, double brake_mps2);

/// Returns a hover at `pose` from `start` on.
models::Trajectory hover_at(const Pose2& pose, double height_m, Time start);

/// True if `motion` stays where it starts: it hovers or turns on the spot.
bool rests(const models::Trajectory& motion);

/// A plan of a teammate starts and drives for at most this number of horizons; its stop comes on
/// top. Longer motions would take unbounded time to process.
inline constexpr int kPlanHorizonsMax = 4;

/// Returns the number of steps from now until every acceptable plan of `robots` has ended and a
/// robot that then brakes has stopped.
int motion_steps_max(const scenario::PlannerSpec& planner,
                     const std::vector<scenario::RobotSpec>& robots);

/// True if `motion` can be a plan of one of `robots` (one horizon and a stop). It must end within
/// kPlanHorizonsMax and the longest stop, and have at most as many segments as these horizons have
/// steps.
bool is_of_plan_length(const models::Trajectory& motion, const scenario::PlannerSpec& planner,
                       const std::vector<scenario::RobotSpec>& robots);

}  // namespace vantage::planner
