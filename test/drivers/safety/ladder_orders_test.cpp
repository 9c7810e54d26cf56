#include <gtest/gtest.h>

#include "drivers/safety/ladder.hpp"
#include "test/drivers/safety/stepped_ladder.hpp"

// Tests when orders end: after a flight, for a vehicle found in the air, and while a vehicle may
// not lift yet.

namespace vantage::drivers {
namespace {

using models::FlightState;
using models::OperatorAction;

class LadderOrders : public ::testing::Test {
 protected:
  void expect_nothing_is_wanted(const char* when) const {
    EXPECT_FALSE(d.ladder.wants_armed) << when;
    EXPECT_FALSE(d.ladder.arm.is_given) << when;
    EXPECT_FALSE(d.ladder.take_off.is_given) << when;
    EXPECT_FALSE(d.ladder.wants_follow) << when;
  }
  /// Places the vehicle on the ground with both orders given (arm, take-off), while another vehicle
  /// lifts.
  void wait_for_its_turn() {
    d.in.autopilot_armed = false;
    d.step(0.01, OperatorAction::kArm);
    d.in.autopilot_armed = true;
    d.in.is_lift_blocked = true;
    d.step(0.01, OperatorAction::kTakeOff);
    ASSERT_EQ(d.ladder.state, FlightState::kIdle);
    ASSERT_TRUE(d.ladder.arm.is_given && d.ladder.take_off.is_given);
  }
  test::SteppedLadder d;
};

TEST_F(LadderOrders, EndWithTheFlight) {
  d.airborne().in.emergency_stop = true;
  EXPECT_EQ(d.step(), FlightState::kKilled);
  expect_nothing_is_wanted("killed in the air");

  d = {};
  d.airborne().in.autopilot_armed = false;
  EXPECT_EQ(d.step(), FlightState::kIdle);
  expect_nothing_is_wanted("the pilot took the motors away");

  d = {};
  wait_for_its_turn();
  d.in.emergency_stop = true;
  EXPECT_EQ(d.step(), FlightState::kKilled);
  expect_nothing_is_wanted("killed on the ground");

  d = {};
  d.airborne();
  EXPECT_EQ(d.step(0.01, OperatorAction::kLand), FlightState::kLand);
  EXPECT_FALSE(d.ladder.wants_follow || d.ladder.arm.is_given || d.ladder.take_off.is_given);
  EXPECT_TRUE(d.ladder.wants_armed) << "must land first";
}

TEST_F(LadderOrders, AreIgnoredInTheTickOfAnEmergencyStop) {
  for (const bool is_found : {false, true}) {
    for (const OperatorAction action : {OperatorAction::kArm, OperatorAction::kTakeOff}) {
      d = {};
      d.in.emergency_stop = true;
      d.in.is_found_flying = is_found;
      EXPECT_EQ(d.step(0.01, action), FlightState::kKilled);
      EXPECT_EQ(d.ladder.refusal, Refusal{});
      expect_nothing_is_wanted("beside a stop");
    }
  }
}

TEST_F(LadderOrders, TakeOffEndsOnceItHasBegun) {
  for (int flight = 0; flight < 2; ++flight) {
    d = {};
    EXPECT_EQ(d.airborne(false).ladder.state, FlightState::kHold);
    EXPECT_FALSE(d.ladder.take_off.is_given);
  }
}

TEST_F(LadderOrders, TakeOffIsRefusedWhenArmingIsRefused) {
  wait_for_its_turn();
  d.in.poses_rejected = d.lim.pose_rejected_hold;  // only the operator clears it
  d.step();
  EXPECT_EQ(d.ladder.refusal.order, Refusal::Order::kArm);
  expect_nothing_is_wanted("refused");
}

TEST_F(LadderOrders, NewOrderClearsTheLastRefusal) {
  for (const OperatorAction next :
       {OperatorAction::kArm, OperatorAction::kLand, OperatorAction::kHold}) {
    d = {};
    d.in.autopilot_armed = false;
    d.step(0.01, OperatorAction::kTakeOff);
    ASSERT_EQ(d.ladder.refusal.order, Refusal::Order::kTakeOff);
    d.step();
    ASSERT_EQ(d.ladder.refusal.order, Refusal::Order::kTakeOff);
    d.step(0.01, next);
    EXPECT_EQ(d.ladder.refusal, Refusal{});
  }
  // The first take-off order was refused because a body stayed near for too long; a new order is
  // given.
  d = {};
  wait_for_its_turn();
  d.in.is_lift_blocked = false;
  d.in.near_m = 0.1;
  d.wait(d.lim.arm_wait_s + 0.1);
  ASSERT_EQ(d.ladder.refusal.order, Refusal::Order::kTakeOff);
  EXPECT_TRUE(d.ladder.refusal.reasons.any());
  d.step(0.01, OperatorAction::kTakeOff);
  EXPECT_EQ(d.ladder.refusal, Refusal{});
}

TEST_F(LadderOrders, VehicleFoundInTheAirHoldsOrContinuesLanding) {
  for (const bool is_flying : {false, true}) {
    for (const bool is_landing : {false, true}) {
      d = {};
      d.step(0.01, OperatorAction::kTakeOff);  // refused: not armed
      ASSERT_EQ(d.ladder.refusal.order, Refusal::Order::kTakeOff);
      d.in.is_found_flying = is_flying;
      d.in.is_found_landing = is_landing;
      d.step();
      if (!is_flying && !is_landing) {
        EXPECT_EQ(d.ladder.state, FlightState::kIdle);
        EXPECT_FALSE(d.ladder.wants_armed);
        continue;
      }
      EXPECT_EQ(d.ladder.state, is_landing ? FlightState::kLand : FlightState::kHold);
      EXPECT_TRUE(d.ladder.wants_armed) << "otherwise the motors would stop in the air";
      EXPECT_EQ(d.ladder.refusal, Refusal{});
      d.in.is_found_flying = d.in.is_found_landing = false;
      d.in.height_m = 1.0;
      EXPECT_EQ(d.step(), is_landing ? FlightState::kLand : FlightState::kHold);
      EXPECT_TRUE(d.ladder.wants_armed);
    }
  }
}

TEST_F(LadderOrders, TakeOffWaitsForNearBodies) {
  for (int time = 0; time < 2; ++time) {
    d = {};
    wait_for_its_turn();
    d.in.is_lift_blocked = false;
    d.in.near_m = 0.1;
    EXPECT_EQ(d.wait(1.0), FlightState::kIdle);
    EXPECT_TRUE(d.ladder.wants_armed) << "does not forbid running motors";
    d.in.near_m = kNever;
    EXPECT_EQ(d.step(), FlightState::kHold);
  }
}

// Idle motors may still stop up to 2.5 s (stop delay plus one heartbeat) after they are requested
// again. If they still run after this time they will not stop, so the take-off begins.
TEST_F(LadderOrders, TakeOffWaitsForStoppingMotors) {
  wait_for_its_turn();
  for (int time = 0; time < 2; ++time) {
    d.in.is_lift_blocked = true;
    d.wait(d.lim.lift_idle_s + 5.0);  // s; long enough that the motors are no longer wanted
    ASSERT_FALSE(d.ladder.wants_armed);
    d.in.is_lift_blocked = false;
    EXPECT_EQ(d.wait(2.45), FlightState::kIdle) << time;
    EXPECT_TRUE(d.ladder.wants_armed);
  }
  EXPECT_EQ(d.wait(0.1), FlightState::kHold);
}

TEST(IsAirborne, IsTrueForFollowHoldAndLand) {
  for (const FlightState state : {FlightState::kFollow, FlightState::kHold, FlightState::kLand}) {
    EXPECT_TRUE(is_airborne(state));
  }
  for (const FlightState state : {FlightState::kIdle, FlightState::kKilled}) {
    EXPECT_FALSE(is_airborne(state));
  }
}

TEST_F(LadderOrders, ArmClearsAKilledVehicleWithStoppedMotors) {
  for (const bool is_heard : {true, false}) {
    d = {};
    d.airborne().in.emergency_stop = true;
    ASSERT_EQ(d.step(), FlightState::kKilled);
    d.in.emergency_stop = false;
    d.in.heartbeat_age_s = is_heard ? 3600.0 : kNever;
    EXPECT_EQ(d.step(0.01, OperatorAction::kArm),
              is_heard ? FlightState::kKilled : FlightState::kIdle);
    d.in.autopilot_armed = false;
    EXPECT_EQ(d.step(0.01, OperatorAction::kArm), FlightState::kIdle);
    EXPECT_TRUE(d.ladder.latched.none()) << "the condition has ended";
  }
}

}  // namespace
}  // namespace vantage::drivers
