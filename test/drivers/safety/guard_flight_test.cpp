// Tests commands, accepted poses and status of the guard in the air. The body moves exactly as the
// test sets it.

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/drivers/safety/one_vehicle.hpp"

namespace vantage::test {
namespace {

using drivers::FlightSetpoint;
using models::FlightState;
using models::OperatorAction;

const Eigen::Vector3d kHigh(-2.0, -1.3, 1.6);

/// Hovers until the reasons reported at the start have cleared.
void hover(OneVehicle& q1) {
  q1.report.armed = q1.report.is_in_our_mode = true;
  q1.run(0.6);
}

/// Commands `follow`, sends a plan that begins 0.1 s later, and runs until it begins.
void follow(OneVehicle& q1, double speed_mps, double height_m) {
  q1.send_command(OperatorAction::kFollow);
  q1.tick();
  models::RobotPlan plan = q1.plan(speed_mps, 0.0, 3.0, height_m, 0.1);
  plan.round = 41;
  EXPECT_EQ(q1.guard.on_plan(plan, q1.now), drivers::PlanVerdict::kAccepted);
  q1.run(0.1 + OneVehicle::kTickS);
}

/// Commands a landing, descends as commanded and switches the motors off on the ground.
void land(OneVehicle& q1) {
  q1.send_command(OperatorAction::kLand);
  q1.run(5.0);
  EXPECT_EQ(q1.out.state, FlightState::kLand);
  EXPECT_LT(q1.position_m.z(), q1.limits.touch_height_m);
  EXPECT_FALSE(q1.out.wants_armed);
  q1.report.armed = false;
  q1.run(0.1);
  EXPECT_EQ(q1.out.state, FlightState::kIdle);
}

struct Phase {
  const char* name;
  bool sinks;
  void (*begin)(OneVehicle& q1);
};

constexpr Phase kPhases[] = {
    {"holding", false, [](OneVehicle& q1) { hover(q1); }},
    {"landing, and moves away from who is below first", false,
     [](OneVehicle& q1) {
       hover(q1);
       q1.others = {q1.body("W1", {kHigh.x(), kHigh.y(), 0.0})};
       q1.send_command(OperatorAction::kLand);
       q1.tick();
     }},
    {"sinking", true,
     [](OneVehicle& q1) {
       hover(q1);
       q1.send_command(OperatorAction::kLand);
       q1.tick();
     }},
    {"holding in a second flight", false,
     [](OneVehicle& q1) {
       hover(q1);
       land(q1);
       EXPECT_FALSE(q1.out.is_sinking);
       q1.position_m = kHigh;
       hover(q1);
     }},
};

// After a gap, the pose of a vehicle that was descending may be lower by the commanded descent. The
// pose of a vehicle that was not descending may not. Both sides of both limits are tested.
TEST(GuardInTheAir, AcceptsALowerPoseOnlyAfterADescent) {
  constexpr double kUnseenS = 0.4;
  for (const Phase& phase : kPhases) {
    for (const double off_m : {-0.01, 0.01}) {
      OneVehicle q1(kHigh);
      phase.begin(q1);
      ASSERT_EQ(q1.out.state == FlightState::kHold, std::string(phase.name).starts_with("holding"));
      EXPECT_EQ(q1.out.is_sinking, phase.sinks) << phase.name;
      EXPECT_EQ(q1.out.climb_to_m < 0.0, phase.sinks) << "the goal is below the floor";
      const double from_m = q1.position_m.z();
      q1.now += from_seconds(kUnseenS);
      q1.position_m.z() -= q1.limits.pose_gate_max_m + off_m;
      q1.position_m.z() -= phase.sinks ? kUnseenS * q1.limits.descent_mps : 0.0;
      q1.deliver_mocap();
      const double seen_m = q1.guard.world_from_body().translation_m.z();
      EXPECT_NEAR(seen_m, off_m < 0.0 ? q1.position_m.z() : from_m, 1e-6) << phase.name;
    }
  }
}

// In the air, poses that repeat bit for bit mean that mocap is stuck. Near the ground they are
// accepted, because the vehicle may be stationary.
TEST(GuardInTheAir, AcceptsIdenticalPosesOnlyNearTheGround) {
  for (const double off_m : {-0.03, 0.03}) {
    OneVehicle q1({-2.0, -1.3, 0.3});
    q1.tracks_setpoint = false;
    hover(q1);
    while (q1.position_m.z() > q1.limits.safe_height_m + off_m + 1e-6) {
      q1.position_m.z() = std::max(q1.position_m.z() - 0.01, q1.limits.safe_height_m + off_m);
      q1.tick();
    }
    q1.run(0.2);
    ASSERT_EQ(q1.out.state, FlightState::kHold);
    q1.is_frozen = true;
    q1.run(q1.limits.pose_stuck_hover_s);
    EXPECT_EQ(q1.guard.inputs().pose_age_s, 0.0);
    q1.run(0.1);
    EXPECT_EQ(q1.guard.inputs().pose_age_s > 0.0, off_m > 0.0);
  }
}

// If the vehicle is commanded to move faster than 0.1 m/s, identical poses are soon refused.
TEST(GuardInTheAir, RefusesIdenticalPosesInMotion) {
  for (const double speed_mps : {0.07, 0.15}) {
    OneVehicle q1(kHigh);
    hover(q1);
    follow(q1, speed_mps, kHigh.z());
    q1.run(0.5);
    ASSERT_EQ(q1.out.state, FlightState::kFollow);
    q1.tracks_setpoint = false;
    q1.is_frozen = true;
    q1.run(0.3);
    EXPECT_EQ(q1.count("pose.stuck") > 0, speed_mps > 0.1);
    EXPECT_EQ(q1.out.state, speed_mps > 0.1 ? FlightState::kHold : FlightState::kFollow);
  }
}

// The plan's clock runs at full rate up to the warning pose age and stops at the maximum pose age.
// In between, its rate decreases linearly.
TEST(GuardInTheAir, SlowsThePlanInProportionToPoseAge) {
  constexpr double kSpeedMps = 0.5;
  constexpr double kStepS = 0.1;
  OneVehicle q1(kHigh);
  hover(q1);
  follow(q1, kSpeedMps, kHigh.z());
  q1.run(0.5);
  q1.tracks_setpoint = false;
  const double warn_s = q1.limits.pose_age_warn_s;
  const double hold_s = q1.limits.pose_age_hold_s;
  for (const double age_s : {0.0, 0.4 * warn_s, warn_s, 0.06, 0.07, 0.085, 0.099}) {
    const double before_m = q1.guard.status(q1.now).setpoint.x_m;
    q1.now += from_seconds(kStepS - age_s);
    q1.position_m.x() = q1.guard.status(q1.now).setpoint.x_m;
    q1.deliver_mocap();
    q1.now += from_seconds(age_s);
    q1.send_command(OperatorAction::kHeartbeat);
    q1.deliver_inputs();
    const drivers::GuardOutput out = q1.guard.tick(q1.now);
    ASSERT_EQ(out.state, FlightState::kFollow);
    EXPECT_NEAR(q1.guard.inputs().pose_age_s, age_s, 1e-6);
    const double share = age_s <= warn_s ? 1.0 : (hold_s - age_s) / (hold_s - warn_s);
    EXPECT_NEAR(q1.guard.status(q1.now).setpoint.x_m - before_m, share * kStepS * kSpeedMps, 1e-5)
        << age_s;
  }
}

// An accepted plan begins at its start time. After `hold` the plan is dropped.
TEST(GuardInTheAir, DropsTheNextPlanAfterHold) {
  for (const bool is_told : {false, true}) {
    OneVehicle q1(kHigh);
    hover(q1);
    q1.send_command(OperatorAction::kFollow);
    q1.tick();
    ASSERT_EQ(q1.out.state, FlightState::kHold) << "no plan yet";
    EXPECT_EQ(q1.guard.on_plan(q1.plan(0.3, 0.0, 3.0, kHigh.z(), 0.1), q1.now),
              drivers::PlanVerdict::kAccepted);
    q1.run(0.05);
    EXPECT_FALSE(q1.guard.inputs().has_plan);
    if (is_told) {
      q1.send_command(OperatorAction::kHold);
    }
    q1.run(0.5);
    EXPECT_EQ(q1.guard.inputs().has_plan, !is_told);
    if (is_told) {
      q1.send_command(OperatorAction::kFollow);
      q1.run(0.5);
      EXPECT_FALSE(q1.guard.inputs().has_plan);
    }
    EXPECT_EQ(q1.out.state, is_told ? FlightState::kHold : FlightState::kFollow);
    EXPECT_EQ(q1.position_m.x() > kHigh.x() + 0.01, !is_told);
  }
}

// During a hold, a vehicle too close to the fence moves away from it. With enough distance it stays
// at its hover position.
TEST(GuardInTheAir, MovesAwayFromTheFenceDuringHold) {
  const double fence_m = -5.0;
  for (const double room_m : {0.02, 0.2}) {
    OneVehicle q1({-2.0, fence_m + 0.25 + room_m, 1.0});
    hover(q1);
    q1.run(2.0);
    ASSERT_EQ(q1.out.state, FlightState::kHold);
    const double edge_m = q1.position_m.y() - fence_m - 0.25;
    EXPECT_GT(edge_m, q1.limits.hover_clearance_m);
    EXPECT_EQ(edge_m > room_m + 0.01, room_m < q1.limits.hover_clearance_m);
  }
}

// While the vehicle waits at the lift height, its commanded trajectory is still at ground height.
// The distance to a teammate must be computed from the measured height.
TEST(GuardInTheAir, MovesAwayFromTheFenceWithoutApproachingATeammate) {
  scenario::Scenario room = OneVehicle::room();
  room.world.bounds.min_m.y() = -0.27;
  OneVehicle q1({0.0, 0.0, 0.0}, 0.0, room);
  q1.begin_lift();
  const Eigen::Vector3d mate_m(0.31, 0.537, 0.45);
  q1.run(6.0, [&] {
    if (q1.position_m.z() > 0.02) {
      q1.others = {q1.body("Q2", mate_m)};
    }
  });
  EXPECT_EQ(q1.state(), FlightState::kHold);
  EXPECT_FALSE(q1.lifts());
  EXPECT_GT(q1.position_m.y() + 0.27 - 0.25, q1.limits.hover_clearance_m)
      << "the vehicle has moved away";
  EXPECT_GT((q1.position_m - mate_m).norm(), 0.6);
}

// The vehicle descends at the configured speed, which is lower near the ground. The commanded
// vertical velocity equals the rate of the commanded height.
TEST(GuardInTheAir, CommandedVerticalSpeedEqualsTheRateOfHeight) {
  OneVehicle q1(kHigh);
  q1.setpoint_offset_m.z() = 0.01;  // avoids a jump of the set-point to the body
  hover(q1);
  q1.send_command(OperatorAction::kLand);
  double height_m = q1.guard.status(q1.now).setpoint_height_m;
  int low = 0;
  for (int tick = 0; tick < 125; ++tick) {
    q1.tick();
    ASSERT_EQ(q1.out.state, FlightState::kLand);
    const bool is_low = height_m < q1.limits.low_height_m;
    const double due_mps = is_low ? q1.limits.low_descent_mps : q1.limits.descent_mps;
    EXPECT_NEAR(q1.out.setpoint.velocity_world_mps.z(), -due_mps, 1e-9) << height_m;
    const double now_m = q1.guard.status(q1.now).setpoint_height_m;
    EXPECT_NEAR(height_m - now_m, OneVehicle::kTickS * due_mps, 1e-9);
    EXPECT_NEAR(q1.out.setpoint.position_world_m.z(), now_m - q1.limits.setpoint_lead_s * due_mps,
                1e-9);
    low += is_low ? 1 : 0;
    height_m = now_m;
  }
  EXPECT_GT(low, 50);
}

// Two ticks at the same instant count as one; the zero time step must not produce a velocity.
TEST(GuardInTheAir, SendsFiniteSetpointsWithoutElapsedTime) {
  OneVehicle q1(kHigh);
  hover(q1);
  q1.send_command(OperatorAction::kLand);
  q1.run(0.3);
  const double height_m = q1.guard.status(q1.now).setpoint_height_m;
  const FlightSetpoint twice = q1.guard.tick(q1.now).setpoint;
  EXPECT_EQ(twice.velocity_world_mps.z(), 0.0);
  EXPECT_EQ(twice.position_world_m.z(), height_m);
  q1.tick();
  EXPECT_LT(q1.out.setpoint.velocity_world_mps.z(), 0.0);
}

// The commanded vertical velocity stays within the limits. This also applies if the vehicle is
// pushed up during a landing, and if the climb and descent limits differ.
TEST(GuardInTheAir, LimitsItsVerticalSpeed) {
  OneVehicle lifted(kHigh);
  hover(lifted);
  lifted.tracks_setpoint = false;
  lifted.send_command(OperatorAction::kLand);
  lifted.run(2.0);
  ASSERT_TRUE(lifted.out.is_sinking);
  lifted.position_m.z() += 0.1;
  lifted.tick();
  EXPECT_EQ(lifted.out.setpoint.velocity_world_mps.z(), lifted.limits.climb_mps);

  drivers::SafetyLimits limits = lifted.limits;
  limits.climb_mps = 0.9;
  ASSERT_LT(limits.descent_mps, limits.climb_mps);
  OneVehicle q1(kHigh, 0.0, OneVehicle::room(), "Q1", limits);
  hover(q1);
  follow(q1, 0.2, kHigh.z() - 0.3);
  q1.run(0.1);
  EXPECT_EQ(q1.out.state, FlightState::kFollow);
  EXPECT_EQ(q1.out.setpoint.velocity_world_mps.z(), -limits.descent_mps);
  const double before_m = q1.out.setpoint.position_world_m.z();
  q1.tick();
  EXPECT_NEAR(before_m - q1.out.setpoint.position_world_m.z(),
              limits.descent_mps * OneVehicle::kTickS, 1e-9)
      << "height and velocity of the set-point agree";
}

// `changed` is set for one tick when either the state or the reasons change.
TEST(GuardInTheAir, ReportsEachChangeOnce) {
  OneVehicle q1(kHigh);
  hover(q1);
  follow(q1, 0.2, kHigh.z());
  q1.run(0.3);
  ASSERT_EQ(q1.out.state, FlightState::kFollow);
  EXPECT_FALSE(q1.out.changed);
  EXPECT_EQ(q1.reasons(), std::vector<std::string>());
  EXPECT_EQ(q1.guard.status(q1.now).plan_round, 41);
  q1.send_command(OperatorAction::kHold);
  q1.tick();
  EXPECT_EQ(q1.out.state, FlightState::kHold);
  EXPECT_TRUE(q1.out.reasons.none());
  EXPECT_TRUE(q1.out.changed) << "only the state changed";
  EXPECT_EQ(q1.reasons(), std::vector<std::string>({"operator"}));
  EXPECT_EQ(q1.guard.status(q1.now).plan_round, -1);
  q1.tick();
  EXPECT_EQ(q1.out.state, FlightState::kHold);
  EXPECT_TRUE(q1.out.changed) << "only the reasons changed";
  EXPECT_EQ(q1.reasons(), std::vector<std::string>({"no plan"}));
  q1.tick();
  EXPECT_FALSE(q1.out.changed);
}

// The status contains the set-point if there is one, otherwise the position.
TEST(VehicleStatus, ReportsSetpointOrPosition) {
  OneVehicle q1(kHigh, 0.5);
  q1.place_on_ground();
  q1.battery_share = 0.7;
  q1.run(0.6);
  const auto expect_at = [&](double x_m, double y_m, double yaw_rad) {
    const models::VehicleStatus status = q1.guard.status(q1.now);
    EXPECT_EQ(status.stamp.time, q1.now);
    EXPECT_EQ(status.robot, "Q1");
    EXPECT_EQ(status.state, q1.out.state);
    EXPECT_EQ(status.battery_share, 0.7);
    EXPECT_EQ(status.plan_round, -1);
    EXPECT_NEAR(status.setpoint.x_m, x_m, 1e-9);
    EXPECT_NEAR(status.setpoint.y_m, y_m, 1e-9);
    EXPECT_NEAR(status.setpoint.yaw_rad, yaw_rad, 1e-9);
  };
  q1.tracks_setpoint = false;
  q1.position_m += Eigen::Vector3d(0.02, 0.03, 0.0);
  q1.yaw_rad = 0.6;
  q1.run(0.02);
  EXPECT_EQ(q1.out.state, FlightState::kIdle);
  expect_at(-1.98, -1.27, 0.6);
  q1.position_m.z() = kHigh.z();
  hover(q1);
  ASSERT_EQ(q1.out.state, FlightState::kHold);
  EXPECT_NEAR(q1.out.climb_to_m, kHigh.z(), 1e-6) << "the height at which the vehicle was found";
  q1.position_m += Eigen::Vector3d(0.04, 0.05, 0.0);
  q1.yaw_rad = 0.8;
  q1.run(0.1);
  expect_at(-1.98, -1.27, 0.6);
  q1.send_command(OperatorAction::kEmergencyStop);
  q1.tick();
  ASSERT_EQ(q1.out.state, FlightState::kKilled);
  expect_at(-1.94, -1.22, 0.8);
}

// Without mocap, the motors count as off after the third consecutive heartbeat that reports this.
// An armed report in between restarts the count.
TEST(GuardInTheAir, IsDisarmedWithoutMocapAtTheThirdReport) {
  OneVehicle q1(kHigh);
  hover(q1);
  q1.has_mocap = false;
  q1.run(0.12);
  ASSERT_EQ(q1.out.state, FlightState::kHold);
  // Sets the content of the next heartbeat.
  const auto turn = [&](bool are_on) {
    q1.report.armed = are_on;
    q1.guard.on_autopilot(q1.report, q1.now);
  };
  for (const int words : {1, 2, 1, 2, 2, 3}) {
    turn(false);
    for (int word = 1; word <= words; ++word) {
      q1.tick();
      EXPECT_EQ(q1.guard.inputs().autopilot_armed, word < 3) << word << " of " << words;
    }
    EXPECT_EQ(q1.out.state, words < 3 ? FlightState::kHold : FlightState::kIdle);
    turn(true);
    q1.tick();
  }
}

// The age of the battery value counts from the first report, even if that report equals the default
// value.
TEST(GuardInTheAir, MeasuresTheAgeOfTheBatteryValue) {
  for (const double share : {1.0, 0.9}) {
    OneVehicle q1(kHigh);
    q1.battery_share = -1.0;  // out of range, therefore refused
    hover(q1);
    q1.battery_share = share;
    q1.tick();
    q1.run(1.0);
    EXPECT_GT(q1.guard.inputs().flight_s, 1.5);
    EXPECT_NEAR(q1.guard.inputs().battery_unchanged_s, 1.0, 1e-6);
    q1.battery_share = share - 0.01;
    q1.tick();
    EXPECT_EQ(q1.guard.inputs().battery_unchanged_s, 0.0);
    q1.run(0.5);
    EXPECT_NEAR(q1.guard.inputs().battery_unchanged_s, 0.5, 1e-6);
  }
}

}  // namespace
}  // namespace vantage::test
