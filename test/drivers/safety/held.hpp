#pragma once

#include <gtest/gtest.h>

#include "drivers/safety/plan_check.hpp"
#include "models/plan/plan.hpp"

namespace vantage::test {

/// A plan as flight safety holds it; it must be one that can be held.
inline drivers::HeldPlan held(const models::Trajectory& way) {
  drivers::HeldPlan plan;
  EXPECT_TRUE(drivers::hold_plan(way, plan));
  return plan;
}

}  // namespace vantage::test
