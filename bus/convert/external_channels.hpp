#pragma once

#include "bus/convert/channels.hpp"

// Of planner.algorithm `external`: what a robot asks another process for, and what it is answered.

namespace vantage::bus {

/// The robot's committed motion from the coming round's start on, as a plan that nobody searched.
inline Channel<models::RobotPlan> external_request_channel(const std::string& robot) {
  return {"EXTERNAL_REQUEST_" + robot};
}
/// The same with other segments.
inline Channel<models::RobotPlan> external_plan_channel(const std::string& robot) {
  return {"EXTERNAL_PLAN_" + robot};
}

}  // namespace vantage::bus
