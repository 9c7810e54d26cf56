#pragma once

#include <vector>

#include "models/plan/plan.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// What is left of `trajectory` from `start` on, as a trajectory that starts then: the same motion
/// to rounding. Before its own start nothing is cut but the wait is lost: precondition start ≥
/// trajectory.start_time.
models::Trajectory rest_of(const models::Trajectory& trajectory, Time start);

/// Stopping at once from the state of `trajectory` at `start`, then hovering.
models::Trajectory stop_from(const models::Trajectory& trajectory, Time start, double brake_mps2);

/// Hovering at `pose` from `start` on.
models::Trajectory hover_at(const Pose2& pose, double height_m, Time start);

/// Whether `motion` stays where it starts: it hovers or turns on the spot.
bool rests(const models::Trajectory& motion);

/// Whether `motion` can be a plan of one of `robots`: over within four horizons and the longest
/// stop (a plan is one horizon and a stop), in no more segments than four horizons have steps. Work
/// on longer ones could take for ever.
bool is_of_plan_length(const models::Trajectory& motion, const scenario::PlannerSpec& planner,
                       const std::vector<scenario::RobotSpec>& robots);

}  // namespace vantage::planner
