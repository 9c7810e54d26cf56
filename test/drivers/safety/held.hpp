#pragma once

#include <gtest/gtest.h>

#include "drivers/safety/plan_check.hpp"
#include "models/plan/plan.hpp"

namespace vantage::test {

/// Returns the plan in the form in which flight safety holds it; fails the test if it cannot be
/// held.
inline drivers::HeldPlan held(const models::Trajectory& way) {
  drivers::HeldPlan plan;
  EXPECT_TRUE(drivers::hold_plan(way, plan));
  return plan;
}

}  // namespace vantage::test
