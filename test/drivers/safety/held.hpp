#pragma once

#include <gtest/gtest.h>

#include "drivers/safety/plan_check.hpp"
#include "models/plan/plan.hpp"

namespace vantage::test {

/// Converts a trajectory to the plan format of flight safety; fails the test if the conversion
/// fails.
inline drivers::HeldPlan held(const models::Trajectory& way) {
  drivers::HeldPlan plan;
  EXPECT_TRUE(drivers::hold_plan(way, plan));
  return plan;
}

}  // namespace vantage::test
