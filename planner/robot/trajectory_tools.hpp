#pragma once

#include <vector>

#include "models/plan/plan.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Returns the part of `trajectory` from `start` on, as a trajectory that starts then; the same
/// motion up to rounding. Precondition: start ≥ trajectory.start_time, because the wait before the
/// start is not represented.
models::Trajectory remainder_of(const models::Trajectory& trajectory, Time start);

/// Returns a motion that brakes from the state of `trajectory` at `start`, then hovers.
models::Trajectory stop_from(const models::Trajectory& trajectory, Time start, double brake_mps2);

/// Returns a hover at `pose` from `start` on.
models::Trajectory hover_at(const Pose2& pose, double height_m, Time start);

/// True if `motion` stays where it starts: it hovers or turns on the spot.
bool is_stationary(const models::Trajectory& motion);

/// Maximum time until a teammate's plan starts, and maximum duration of its motion without the
/// stop, in horizons. Longer motions would take unbounded time to process.
inline constexpr int kPlanHorizonsMax = 4;

/// Returns the number of steps from the present until every acceptable plan of `robots` has ended
/// and a robot that then brakes has stopped.
int motion_steps_max(const scenario::PlannerSpec& planner,
                     const std::vector<scenario::RobotSpec>& robots);

/// True if `motion` can be a plan of one of `robots` (one horizon and a stop). It must end within
/// kPlanHorizonsMax horizons plus the longest stop, and have at most as many segments as these
/// horizons have steps.
bool is_of_plan_length(const models::Trajectory& motion, const scenario::PlannerSpec& planner,
                       const std::vector<scenario::RobotSpec>& robots);

}  // namespace vantage::planner
