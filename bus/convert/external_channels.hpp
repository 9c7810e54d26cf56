#pragma once

#include "bus/convert/channels.hpp"

// Channels of planner.algorithm `external`: a robot's request to another process, and the answer.

namespace vantage::bus {

/// The request: the robot's committed motion from the start of the next round, as a plan without a
/// search.
inline Channel<models::RobotPlan> external_request_channel(const std::string& robot) {
  return {"EXTERNAL_REQUEST_" + robot};
}
/// The answer: the same plan with other segments.
inline Channel<models::RobotPlan> external_plan_channel(const std::string& robot) {
  return {"EXTERNAL_PLAN_" + robot};
}

}  // namespace vantage::bus
