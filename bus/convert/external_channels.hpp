#pragma once

#include "bus/convert/channels.hpp"

// Channels of planner.algorithm `external`: a robot requests a plan from another process, which
// answers.

namespace vantage::bus {

/// Returns the channel of the requests to the external planner. A request contains the robot's
/// committed motion from the start of the next round, as a plan without search results.
inline Channel<models::RobotPlan> external_request_channel(const std::string& robot) {
  return {"EXTERNAL_REQUEST_" + robot};
}
/// Returns the channel of the external planner's answers. An answer is the requested plan with
/// other segments.
inline Channel<models::RobotPlan> external_plan_channel(const std::string& robot) {
  return {"EXTERNAL_PLAN_" + robot};
}

}  // namespace vantage::bus
