#include "drivers/safety/limits.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/support/stated.hpp"
#include "wire/autopilot/parameter_rules.hpp"

// Compares every value of SafetyLimits with its definition. Values for all labs are defined in
// docs/explanation/safety.md and docs/reference/faults.md, the others in the scenario.

namespace vantage::drivers {
namespace {

TEST(SafetyLimits, MatchTheDocuments) {
  const SafetyLimits is;
  const std::vector<test::Stated> rows = {
      {"pose_age_warn_s", is.pose_age_warn_s, 0.05},
      {"pose_age_hold_s", is.pose_age_hold_s, 0.1},
      {"pose_age_land_s", is.pose_age_land_s, 0.5},
      {"pose_age_kill_s", is.pose_age_kill_s, 1.5},
      {"safe_height_m", is.safe_height_m, 0.15},
      {"touch_height_m", is.touch_height_m, 0.06},
      {"pose_latency_hold_s", is.pose_latency_hold_s, 0.1},
      {"pose_rejected_hold", static_cast<double>(is.pose_rejected_hold), 3},
      {"pose_frames_to_arm", static_cast<double>(is.pose_frames_to_arm), 50},
      {"pose_gate_m", is.pose_gate_m, 0.25},
      {"pose_gate_max_m", is.pose_gate_max_m, 0.26},
      {"pose_flip_rad", is.pose_flip_rad, 1.0},
      {"pose_stuck_moving_s", is.pose_stuck_moving_s, 0.05},
      {"pose_stuck_hover_s", is.pose_stuck_hover_s, 0.5},
      {"volume_margin_m", is.volume_margin_m, 1.0},
      {"round_s", is.round_s, 0.0},
      {"plan_age_hold_s", is.plan_age_hold_s, 2.0},
      {"plan_silent_warn_s", is.plan_silent_warn_s, 2.0},
      {"plans_late_hold", static_cast<double>(is.plans_late_hold), 3},
      {"plan_past_max_s", is.plan_past_max_s, 0.5},
      {"plan_future_max_s", is.plan_future_max_s, 5.0},
      {"plan_start_tolerance_m", is.plan_start_tolerance_m, 0.4},
      {"plan_start_turn_rad", is.plan_start_turn_rad, 0.8},
      {"planner_lease_s", is.planner_lease_s, 2.0},
      {"other_version_clear_s", is.other_version_clear_s, 5.0},
      {"tracking_hold_m", is.tracking_hold_m, 0.4},
      {"tracking_land_m", is.tracking_land_m, 1.0},
      {"fence_land_m", is.fence_land_m, 0.0},
      {"fence_kill_m", is.fence_kill_m, 1.0},
      {"reaction_s", is.reaction_s, 0.2},
      {"setpoint_loss_s", is.setpoint_loss_s, 0.3},
      {"separation_hold_m", is.separation_hold_m, 0.55},
      {"separation_land_m", is.separation_land_m, 0.5},
      {"plan_separation_m", is.plan_separation_m, 0.6},
      {"speed_hold_ratio", is.speed_hold_ratio, 1.3},
      {"other_pose_growth_mps", is.other_pose_growth_mps, 0.5},
      {"other_pose_growth_max_m", is.other_pose_growth_max_m, 0.5},
      {"other_turn_mps2", is.other_turn_mps2, 3.0},
      {"other_prediction_s", is.other_prediction_s, 3.0},
      {"landing_prediction_s", is.landing_prediction_s, 1.5},
      {"descent_prediction_s", is.descent_prediction_s, 0.5},
      {"hover_clearance_m", is.hover_clearance_m, 0.1},
      {"landing_clearance_m", is.landing_clearance_m, 0.7},
      {"lateral_max_mps2", is.lateral_max_mps2, 10.0},
      {"take_off_height_m", is.take_off_height_m, 1.0},
      {"setpoint_lead_s", is.setpoint_lead_s, 0.1},
      {"acceleration_lead_s", is.acceleration_lead_s, 0.1},
      {"climb_mps", is.climb_mps, 0.5},
      {"descent_mps", is.descent_mps, 0.6},
      {"low_descent_mps", is.low_descent_mps, 0.4},
      {"low_height_m", is.low_height_m, 1.0},
      {"body_tilt_arm_rad", is.body_tilt_arm_rad, 0.26},            // 15°
      {"attitude_error_arm_rad", is.attitude_error_arm_rad, 0.17},  // 10°
      {"yaw_error_arm_rad", is.yaw_error_arm_rad, 0.26},            // 15°
      {"start_off_arm_m", is.start_off_arm_m, 0.5},
      {"start_turn_arm_rad", is.start_turn_arm_rad, 0.3},  // 17°
      {"lift_height_m", is.lift_height_m, 0.2},
      {"lift_done_m", is.lift_done_m, 0.3},
      {"lift_risen_m", is.lift_risen_m, 0.1},
      {"lift_wait_s", is.lift_wait_s, 6.0},
      {"lift_idle_s", is.lift_idle_s, 5.0},
      {"lift_proof_s", is.lift_proof_s, 8.0},
      {"lift_step_m", is.lift_step_m, 0.15},
      {"lift_turn_rad", is.lift_turn_rad, 0.2},
      {"lift_deviation_m", is.lift_deviation_m, 0.3},
      {"lift_other_rise_m", is.lift_other_rise_m, 0.06},
      {"lift_climb_error_mps", is.lift_climb_error_mps, 0.35},
      {"lift_turn_error_radps", is.lift_turn_error_radps, 0.8},
      {"arm_wait_s", is.arm_wait_s, 10.0},
      {"take_off_prediction_s", is.take_off_prediction_s, 1.0},
      {"battery_arm_share", is.battery_arm_share, 0.30},
      {"battery_low_share", is.battery_low_share, 0.25},
      {"battery_land_share", is.battery_land_share, 0.15},
      {"battery_empty_share", is.battery_empty_share, 0.05},
      {"battery_age_land_s", is.battery_age_land_s, 10.0},
      {"battery_stuck_land_s", is.battery_stuck_land_s, 60.0},
      {"flight_max_s", is.flight_max_s, 900.0},
      {"heartbeat_age_hold_s", is.heartbeat_age_hold_s, 1.5},
      {"heartbeat_age_land_s", is.heartbeat_age_land_s, 3.0},
      {"telemetry_age_hold_s", is.telemetry_age_hold_s, 0.5},
      {"estimate_error_hold_m", is.estimate_error_hold_m, 0.3},
      {"estimate_error_land_m", is.estimate_error_land_m, 1.0},
      {"velocity_error_hold_mps", is.velocity_error_hold_mps, 0.3},
      {"velocity_error_land_mps", is.velocity_error_land_mps, 0.45},
      {"velocity_memory_s", is.velocity_memory_s, 1.0},
      {"hover_speed_mps", is.hover_speed_mps, 0.25},
      {"hover_off_m", is.hover_off_m, 0.2},
      {"sink_error_m", is.sink_error_m, 0.35},
      {"tilt_kill_rad", is.tilt_kill_rad, 1.05},  // 60°
      {"needs_operator", is.needs_operator ? 1.0 : 0.0, 1.0},
      {"operator_age_hold_s", is.operator_age_hold_s, 1.0},
      {"operator_age_land_s", is.operator_age_land_s, 3.0},
      {"stall_hold_s", is.stall_hold_s, 0.25},
      {"processor_wait_hold_s", is.processor_wait_hold_s, 0.30},
      {"processor_wait_arm_s", is.processor_wait_arm_s, 0.15},
      {"clear_s", is.clear_s, 0.5},
      {"yield_s", is.yield_s, 2.0},
  };
  test::expect_as_stated(rows);
}

class LimitsFromTheScenario : public testing::Test {
 protected:
  LimitsFromTheScenario() {
    scenario.planner.separation_m = 0.9;
    scenario.planner.tracking_tolerance_m = 0.15;
    scenario.planner.obstacle_margin_m = 0.13;
    scenario.planner.execute_steps = 7;
    scenario.planner.step_s = 0.6;
    scenario.robots[0].limits = {1.2, 2.7, 1.9, 0.22};
    scenario.robots[0].height_m = 1.4;
    scenario.world.ceiling_m = 2.9;
  }
  [[nodiscard]] SafetyLimits of(const std::string& robot = "Q1") const {
    return limits_for(scenario, robot);
  }
  scenario::Scenario scenario = test::FlightBench::scenario();
};

TEST_F(LimitsFromTheScenario, DerivesLimitsFromTheScenario) {
  const SafetyLimits is = of();
  EXPECT_EQ(is.fence.bounds.min_m, scenario.world.bounds.min_m);
  EXPECT_EQ(is.fence.bounds.max_m, scenario.world.bounds.max_m);
  EXPECT_EQ(is.fence.ceiling_m, 2.9);
  EXPECT_EQ(is.fence.obstacles.size(), scenario.world.obstacles.size());
  EXPECT_EQ(is.vehicle.speed_max_mps, 1.2);
  EXPECT_EQ(is.vehicle.yaw_rate_max_radps, 2.7);
  EXPECT_EQ(is.vehicle.brake_mps2, 1.9);
  EXPECT_EQ(is.vehicle.radius_m, 0.22);
  EXPECT_EQ(is.take_off_height_m, 1.4);
  // Vehicles touch at 0.44 m and the planner keeps 0.9 m. The hold distance is half-way between.
  EXPECT_NEAR(is.plan_separation_m, 0.89, 1e-12);
  EXPECT_NEAR(is.separation_land_m, 0.44, 1e-12);
  EXPECT_NEAR(is.separation_hold_m, 0.67, 1e-12);
  EXPECT_NEAR(is.landing_clearance_m, 0.64, 1e-12);
  EXPECT_NEAR(is.pose_gate_max_m, 0.3216, 1e-12);
  EXPECT_NEAR(is.hover_off_m, 0.15, 1e-12);
  EXPECT_NEAR(is.hover_clearance_m, 0.13, 1e-12);
  // A round takes 4.2 s.
  EXPECT_NEAR(is.round_s, 4.2, 1e-12);
  EXPECT_NEAR(is.plan_age_hold_s, 4.7, 1e-12);
  EXPECT_NEAR(is.plan_silent_warn_s, 4.7, 1e-12);
  EXPECT_NEAR(is.planner_lease_s, 4.7, 1e-12);
  EXPECT_NEAR(is.plan_future_max_s, 8.4, 1e-12);
  // The limits are two and five times the tracking tolerance.
  EXPECT_NEAR(is.tracking_hold_m, 0.30, 1e-12);
  EXPECT_NEAR(is.tracking_land_m, 0.75, 1e-12);
  EXPECT_NEAR(is.plan_start_tolerance_m, 0.30, 1e-12);
  // Each robot has its own limits.
  EXPECT_EQ(of("Q2").vehicle.speed_max_mps, scenario.robots[1].limits.speed_max_mps);
  EXPECT_EQ(of("Q2").take_off_height_m, scenario.robots[1].height_m);
}

TEST_F(LimitsFromTheScenario, KeepsMinimumLimits) {
  scenario.planner.execute_steps = 1;  // a round of 0.6 s
  scenario.planner.obstacle_margin_m = 0.01;
  scenario.planner.separation_m = 0.445;  // vehicles touch at 0.44 m
  const SafetyLimits is = of();
  EXPECT_NEAR(is.round_s, 0.6, 1e-12);
  EXPECT_EQ(is.plan_age_hold_s, 2.0);
  EXPECT_EQ(is.plan_silent_warn_s, 2.0);
  EXPECT_EQ(is.planner_lease_s, 2.0);
  EXPECT_EQ(is.plan_future_max_s, 5.0);
  EXPECT_EQ(is.hover_clearance_m, 0.05);
  EXPECT_NEAR(is.separation_hold_m, 0.45, 1e-12);
  EXPECT_NEAR(is.plan_separation_m, 0.435, 1e-12);
  EXPECT_LT(is.pose_gate_max_m, 0.5 * is.separation_hold_m);
  EXPECT_LT(is.pose_gate_m, is.pose_gate_max_m);
}

TEST_F(LimitsFromTheScenario, KeepsDefaultsThatTheScenarioDoesNotDetermine) {
  const SafetyLimits is = of();
  const SafetyLimits stated;
  EXPECT_EQ(is.pose_age_hold_s, stated.pose_age_hold_s);
  EXPECT_EQ(is.pose_gate_m, stated.pose_gate_m);
  EXPECT_EQ(is.fence_kill_m, stated.fence_kill_m);
  EXPECT_EQ(is.setpoint_loss_s, stated.setpoint_loss_s);
  EXPECT_EQ(is.clear_s, stated.clear_s);
  EXPECT_EQ(is.yield_s, stated.yield_s);
  EXPECT_EQ(is.operator_age_land_s, stated.operator_age_land_s);
  EXPECT_TRUE(is.needs_operator);
  EXPECT_EQ(is.reaction_s, 0.20);
}

// See "When a driver dies in motion" in docs/explanation/safety.md. The budget covers each vehicle
// that arms, because a longer time-out forbids arming
// (Parameters.ForbidArmingWithATimeOutBeyondTheBudget).
TEST_F(LimitsFromTheScenario, BudgetsReactionAndTimeOutPerDialect) {
  using models::AutopilotDialect;
  struct Budget {
    AutopilotDialect dialect;
    const char* time_out;
    double setpoint_loss_s;
    double stopping_distance_m;  // m; from 1 m/s, braking at 2 m/s²
    double stopping_distance_after_loss_m;
  };
  scenario.robots[0].limits.brake_mps2 = 2.0;
  for (const Budget& stated :
       {Budget{AutopilotDialect::kPx4, "COM_OF_LOSS_T", 0.30, 0.45, 0.75},
        Budget{AutopilotDialect::kArdupilot, "GUID_TIMEOUT", 0.45, 0.45, 0.90}}) {
    SCOPED_TRACE(name_of(stated.dialect));
    scenario.robots[0].autopilot.emplace().dialect = stated.dialect;
    const SafetyLimits is = of();
    EXPECT_EQ(is.reaction_s, 0.20);
    EXPECT_NEAR(is.setpoint_loss_s, stated.setpoint_loss_s, 1e-12);
    EXPECT_NEAR(stopping_distance_m(is, 1.0), stated.stopping_distance_m, 1e-12);
    EXPECT_NEAR(stopping_distance_after_loss_m(is, 1.0), stated.stopping_distance_after_loss_m,
                1e-12);
    const auto& rules = wire::parameter_rules(stated.dialect);
    const auto rule = std::find_if(rules.begin(), rules.end(),
                                   [&](const auto& each) { return each.name == stated.time_out; });
    ASSERT_NE(rule, rules.end());
    EXPECT_TRUE(rule->accepts(0.3));
    EXPECT_FALSE(rule->accepts(0.31)) << "a longer timeout exceeds the stopping distance";
  }
}

// The half window is half the time to accelerate from rest to the maximum speed at the braking
// deceleration.
TEST(HalfWindow, IsHalfTheTimeToTheGreatestSpeed) {
  struct Vehicle {
    double speed_max_mps, brake_mps2, half_window_s;
  };
  for (const Vehicle& is : {Vehicle{1.0, 2.0, 0.25}, Vehicle{1.2, 1.5, 0.4},
                            Vehicle{3.0, 4.0, 0.375}, Vehicle{0.4, 0.5, 0.4}}) {
    models::VehicleLimits vehicle;
    vehicle.speed_max_mps = is.speed_max_mps;
    vehicle.brake_mps2 = is.brake_mps2;
    EXPECT_NEAR(half_window_s(vehicle), is.half_window_s, 1e-12) << is.speed_max_mps;
    EXPECT_NEAR(2.0 * half_window_s(vehicle) * is.brake_mps2, is.speed_max_mps, 1e-12);
  }
}

TEST_F(LimitsFromTheScenario, RefusesAnUnknownRobot) { EXPECT_THROW(of("Q9"), UsageError); }

// The limits of each ladder must be finite and increase strictly.
TEST(CheckLimits, RefusesLimitsThatDoNotIncrease) {
  using Limit = double SafetyLimits::*;
  using L = SafetyLimits;
  const std::vector<std::pair<Limit, Limit>> rising = {
      {&L::pose_age_warn_s, &L::pose_age_hold_s},
      {&L::pose_age_hold_s, &L::pose_age_land_s},
      {&L::pose_age_land_s, &L::pose_age_kill_s},
      {&L::pose_gate_m, &L::pose_gate_max_m},
      {&L::tracking_hold_m, &L::tracking_land_m},
      {&L::lift_other_rise_m, &L::lift_risen_m},
      {&L::lift_risen_m, &L::lift_height_m},
      {&L::lift_height_m, &L::lift_done_m},
      {&L::lift_step_m, &L::lift_deviation_m},
      {&L::low_descent_mps, &L::descent_mps},
      {&L::separation_land_m, &L::separation_hold_m},
      {&L::battery_empty_share, &L::battery_land_share},
      {&L::battery_land_share, &L::battery_low_share},
      {&L::battery_low_share, &L::battery_arm_share},
      {&L::heartbeat_age_hold_s, &L::heartbeat_age_land_s},
      {&L::estimate_error_hold_m, &L::estimate_error_land_m},
      {&L::velocity_error_hold_mps, &L::velocity_error_land_mps},
      {&L::operator_age_hold_s, &L::operator_age_land_s},
      {&L::processor_wait_arm_s, &L::processor_wait_hold_s},
  };
  const SafetyLimits good = limits_for(test::FlightBench::scenario(), "Q1");
  check_limits(good);
  for (std::size_t i = 0; i < rising.size(); ++i) {
    const auto [low, high] = rising[i];
    SafetyLimits bad = good;
    bad.*low = bad.*high;
    EXPECT_THROW(check_limits(bad), UsageError) << i << ": equal";
    bad = good;
    bad.*low = 0.0;
    EXPECT_THROW(check_limits(bad), UsageError) << i << ": zero";
    bad = good;
    bad.*low = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(check_limits(bad), UsageError) << i << ": not a number";
    bad = good;
    bad.*high = std::numeric_limits<double>::infinity();
    EXPECT_THROW(check_limits(bad), UsageError) << i << ": infinite";
  }
}

TEST(CheckLimits, RefusesValuesThatAreNotPositiveAndFinite) {
  const SafetyLimits good = limits_for(test::FlightBench::scenario(), "Q1");
  const std::vector<double* (*)(SafetyLimits&)> limits = {
      [](SafetyLimits& l) { return &l.safe_height_m; },
      [](SafetyLimits& l) { return &l.reaction_s; },
      [](SafetyLimits& l) { return &l.setpoint_loss_s; },
      [](SafetyLimits& l) { return &l.plan_separation_m; },
      [](SafetyLimits& l) { return &l.planner_lease_s; },
      [](SafetyLimits& l) { return &l.climb_mps; },
      [](SafetyLimits& l) { return &l.low_height_m; },
      [](SafetyLimits& l) { return &l.other_turn_mps2; },
      [](SafetyLimits& l) { return &l.other_prediction_s; },
      [](SafetyLimits& l) { return &l.landing_prediction_s; },
      [](SafetyLimits& l) { return &l.descent_prediction_s; },
      [](SafetyLimits& l) { return &l.flight_max_s; },
      [](SafetyLimits& l) { return &l.lift_wait_s; },
      [](SafetyLimits& l) { return &l.lift_proof_s; },
      [](SafetyLimits& l) { return &l.arm_wait_s; },
      [](SafetyLimits& l) { return &l.clear_s; },
      [](SafetyLimits& l) { return &l.velocity_memory_s; },
      [](SafetyLimits& l) { return &l.hover_speed_mps; },
      [](SafetyLimits& l) { return &l.hover_off_m; },
      [](SafetyLimits& l) { return &l.sink_error_m; },
      [](SafetyLimits& l) { return &l.vehicle.speed_max_mps; },
      [](SafetyLimits& l) { return &l.vehicle.yaw_rate_max_radps; },
      [](SafetyLimits& l) { return &l.vehicle.brake_mps2; },
      [](SafetyLimits& l) { return &l.take_off_height_m; },
  };
  for (std::size_t i = 0; i < limits.size(); ++i) {
    for (const double value : {0.0, -1.0, std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN()}) {
      SafetyLimits bad = good;
      *limits[i](bad) = value;
      EXPECT_THROW(check_limits(bad), UsageError) << i << " is " << value;
    }
  }
  SafetyLimits low = good;
  low.fence.ceiling_m = low.take_off_height_m;
  EXPECT_THROW(check_limits(low), UsageError) << "the take-off height must be below the ceiling";
  low.fence.ceiling_m += 1e-9;
  check_limits(low);
}

}  // namespace
}  // namespace vantage::drivers
