#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "planner/team/robot_planner.hpp"
#include "test/planner/team_scenario.hpp"

namespace vantage::planner {
namespace {

// Stopped by its driver it stands where that stopped it, turned otherwise than its plan, and will
// not come back: flown, 49 plans in a row began at the plan's heading and were refused.
TEST(RobotPlanner, BeginsWhereItsVehicleHolds) {
  const models::Scenario scenario = test::lab_scenario();
  PlanInputs inputs = test::first_inputs(scenario, 0);
  inputs.own_plan = RobotPlanner(scenario, "Q1").plan(inputs, Deadline::nodes(500));
  ASSERT_TRUE(inputs.own_plan);
  const Pose2 planned =
      models::at(inputs.own_plan->trajectory, inputs.slot.activation).world_from_body;
  models::VehicleStatus& status = inputs.team_statuses["Q1"];
  status.stamp.time = inputs.slot.activation;
  const auto start = [&](models::FlightState state, const Pose2& off) {
    status.state = state;
    status.setpoint = {planned.x_m + off.x_m, planned.y_m + off.y_m,
                       wrap_to_pi(planned.yaw_rad + off.yaw_rad)};
    const auto plan = RobotPlanner(scenario, "Q1").plan(inputs, Deadline::nodes(500));
    return plan ? plan->trajectory.start : Pose2{99.0, 99.0, 0.0};
  };
  for (const Pose2& off :
       {Pose2{0.0, 0.0, 1.2}, Pose2{0.0, 0.0, -1.2}, Pose2{0.3, 0.0, 0.0}, Pose2{0.0, -0.3, 0.0}}) {
    const Pose2 held = start(models::FlightState::kHold, off);
    EXPECT_LT((held.position_m() - status.setpoint.position_m()).norm(), 1e-9);
    EXPECT_NEAR(wrap_to_pi(held.yaw_rad - status.setpoint.yaw_rad), 0.0, 1e-9);
    EXPECT_EQ(start(models::FlightState::kFollow, off), planned);  // its feedback brings it back
  }
  EXPECT_EQ(start(models::FlightState::kHold, {0.1, 0.1, 0.3}), planned);  // near enough
}

}  // namespace
}  // namespace vantage::planner
