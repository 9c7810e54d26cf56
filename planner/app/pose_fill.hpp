#pragma once

#include "models/exchange/messages.hpp"
#include "models/exchange/pose_messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// If `frame` does not show the robot of `estimate`, adds its estimated pose, moved to the time of
/// the frame with the robot's last known motion. Returns true if the pose was added. Estimates
/// without a pose, without motion or more than kPoseAgeMax from the frame are not used.
bool show_robot(const scenario::Scenario& scenario, const models::PoseEstimate& estimate,
                models::MocapFrame& frame);

/// Maximum time between an estimated pose and the frame to which it is added.
inline constexpr Duration kPoseAgeMax = std::chrono::milliseconds(500);

}  // namespace vantage::planner
