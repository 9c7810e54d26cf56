#pragma once

#include "models/exchange/messages.hpp"
#include "models/exchange/pose_messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// If `frame` does not show the robot of `estimate`, adds its estimated pose, extrapolated to the
/// time of the frame by the robot's last known motion. Returns true if the pose was added.
/// Estimates without a pose or without motion are not used, and neither are those more than
/// kPoseAgeMax older or newer than the frame.
bool show_robot(const scenario::Scenario& scenario, const models::PoseEstimate& estimate,
                models::MocapFrame& frame);

/// Maximum time between an estimated pose and the frame to which it is added.
inline constexpr Duration kPoseAgeMax = std::chrono::milliseconds(500);

}  // namespace vantage::planner
