#include "drivers/safety/ladder.hpp"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "test/drivers/safety/stepped_ladder.hpp"
#include "test/support/allocation_counter.hpp"

namespace vantage::drivers {
namespace {

using models::FlightState;
using models::OperatorAction;

using test::limits;
using test::SteppedLadder;

class StepLadder : public ::testing::Test {
 protected:
  SteppedLadder d;
};

TEST_F(StepLadder, HoldsAfterTakeOffUntilFollow) {
  EXPECT_EQ(d.airborne(false).ladder.state, FlightState::kHold);
  EXPECT_EQ(d.wait(5.0), FlightState::kHold);
  EXPECT_EQ(d.step(0.01, OperatorAction::kFollow), FlightState::kFollow);
  EXPECT_EQ(d.step(0.01, OperatorAction::kHold), FlightState::kHold);
  EXPECT_EQ(d.wait(5.0), FlightState::kHold);
}

TEST_F(StepLadder, DoesNotArmWhileBlocked) {
  d.in.autopilot_armed = false;
  d.in.battery_share = 0.29;
  d.step(0.01, OperatorAction::kArm);
  EXPECT_FALSE(d.ladder.wants_armed);
  d.in.battery_share = 0.31;
  d.step(0.01, OperatorAction::kArm);
  EXPECT_TRUE(d.ladder.wants_armed);
  d.in.operator_age_s = 1.5;
  d.step();
  EXPECT_FALSE(d.ladder.wants_armed) << "armed on the ground while the operator is away";
}

TEST_F(StepLadder, HoldsForAStalePoseAndResumesHalfASecondLater) {
  d.airborne().in.pose_age_s = 0.11;
  EXPECT_EQ(d.step(), FlightState::kHold);
  d.in.pose_age_s = 0.0;
  EXPECT_EQ(d.wait(0.45), FlightState::kHold);
  EXPECT_EQ(d.wait(0.10), FlightState::kFollow);
}

TEST_F(StepLadder, WaitsForTheOperatorWhereTheRowRequiresIt) {
  d.airborne().in.poses_rejected = 3;
  EXPECT_EQ(d.step(), FlightState::kHold);
  EXPECT_EQ(d.step(0.01, OperatorAction::kFollow), FlightState::kHold)
      << "the condition still holds";
  d.in.poses_rejected = 0;
  EXPECT_EQ(d.wait(10.0), FlightState::kHold);
  EXPECT_EQ(d.step(0.01, OperatorAction::kFollow), FlightState::kFollow);
}

TEST_F(StepLadder, NeverLeavesALandingBeforeTheGround) {
  d.airborne().in.pose_age_s = 0.6;
  EXPECT_EQ(d.step(), FlightState::kLand);
  d.in.pose_age_s = 0.0;
  for (const OperatorAction action :
       {OperatorAction::kFollow, OperatorAction::kHold, OperatorAction::kTakeOff}) {
    d.step(0.01, action);
    EXPECT_EQ(d.wait(2.0), FlightState::kLand);
  }
  d.in.height_m = 0.01;
  d.step();
  EXPECT_FALSE(d.ladder.wants_armed);
  d.in.autopilot_armed = false;
  EXPECT_EQ(d.step(), FlightState::kIdle);
}

// An estimated height must not disarm. When the pose is older than the hold limit, the motors stay
// armed.
TEST_F(StepLadder, StaysArmedInALandingWithAnEstimatedHeight) {
  for (int time = 0; time < 2; ++time) {
    d = SteppedLadder();
    d.airborne();
    EXPECT_EQ(d.step(0.01, OperatorAction::kLand), FlightState::kLand);
    d.in.height_m = d.lim.touch_height_m - 0.001;
    d.in.pose_age_s = d.lim.pose_age_hold_s;
    d.wait(1.0);
    EXPECT_TRUE(d.ladder.wants_armed) << "the pose has the largest age without a hold";
    d.in.pose_age_s = d.lim.pose_age_hold_s - 0.001;
    d.in.height_m = d.lim.touch_height_m;
    d.step();
    EXPECT_TRUE(d.ladder.wants_armed) << "not yet down";
    d.in.height_m = d.lim.touch_height_m - 0.001;
    d.step();
    EXPECT_FALSE(d.ladder.wants_armed);
    d.in.pose_age_s = 1.0;
    d.step();
    EXPECT_FALSE(d.ladder.wants_armed) << "the motors do not start again after touchdown";
  }
}

// A condition takes effect after it was true for an uninterrupted time. It clears after it was
// false for an uninterrupted time clear_s. Shorter periods do not add up.
TEST_F(StepLadder, RequiresConditionsForAnUninterruptedTime) {
  d.airborne();
  for (int time = 0; time < 2; ++time) {
    for (int burst = 0; burst < 3; ++burst) {  // "tracking" must be true for 0.1 s
      d.in.tracking_error_m = d.lim.tracking_hold_m + 0.01;
      EXPECT_EQ(d.wait(0.09), FlightState::kFollow) << "burst " << burst;
      d.in.tracking_error_m = d.lim.tracking_hold_m;
      EXPECT_EQ(d.step(), FlightState::kFollow);
    }
    d.in.tracking_error_m = d.lim.tracking_hold_m + 0.01;
    EXPECT_EQ(d.wait(0.12), FlightState::kHold);
    for (int burst = 0; burst < 3; ++burst) {  // the condition must be false for clear_s
      d.in.tracking_error_m = 0.0;
      EXPECT_EQ(d.wait(0.45), FlightState::kHold) << "gone " << burst;
      d.in.tracking_error_m = d.lim.tracking_hold_m + 0.01;
      EXPECT_EQ(d.step(), FlightState::kHold);
    }
    d.in.tracking_error_m = 0.0;
    EXPECT_EQ(d.wait(0.49), FlightState::kHold);
    EXPECT_EQ(d.wait(0.03), FlightState::kFollow);
  }
}

// A vehicle that must yield, because its name sorts later, holds longer by yield_s. Tested twice.
TEST_F(StepLadder, HoldsLongerByTheYieldTimeWhenItYields) {
  d.airborne();
  for (int time = 0; time < 2; ++time) {
    for (const bool yields : {true, false}) {
      d.in.yields = yields;
      d.in.separation_stop_m = d.lim.separation_hold_m - 0.01;
      EXPECT_EQ(d.step(), FlightState::kHold);
      d.in.separation_stop_m = d.lim.separation_hold_m;
      const double wait_s = d.lim.clear_s + (yields ? d.lim.yield_s : 0.0);
      EXPECT_EQ(d.wait(wait_s - 0.01), FlightState::kHold);
      EXPECT_EQ(d.wait(0.03), FlightState::kFollow);
    }
  }
}

TEST_F(StepLadder, WaitsForTheOperatorEachTime) {
  d.airborne();
  for (int time = 0; time < 2; ++time) {
    d.in.poses_rejected = d.lim.pose_rejected_hold;
    EXPECT_EQ(d.step(), FlightState::kHold);
    d.in.poses_rejected = d.lim.pose_rejected_hold - 1;
    EXPECT_EQ(d.wait(3.0), FlightState::kHold);
    EXPECT_EQ(d.step(0.01, OperatorAction::kFollow), FlightState::kFollow);
    EXPECT_EQ(d.wait(3.0), FlightState::kFollow);
  }
}

// Tests the time limit of an order that is forbidden on the ground. A new order starts a new limit.
TEST_F(StepLadder, DropsAnOrderAfterTheTimeLimit) {
  d.in.autopilot_armed = false;
  for (int time = 0; time < 2; ++time) {
    d.in.pose_age_s = d.lim.pose_age_hold_s + 0.01;  // clears without the operator
    d.step(0.01, OperatorAction::kArm);
    EXPECT_TRUE(d.ladder.arm.is_given);
    EXPECT_EQ(d.ladder.refusal.order, Refusal::Order::kNone);
    d.wait(d.lim.arm_wait_s - 0.02);
    EXPECT_TRUE(d.ladder.arm.is_given);
    d.wait(0.05);
    EXPECT_FALSE(d.ladder.arm.is_given);
    EXPECT_EQ(d.ladder.refusal.order, Refusal::Order::kArm);
    EXPECT_TRUE(d.ladder.refusal.reasons.any());
    d.in.pose_age_s = 0.0;
    d.wait(5.0);
    EXPECT_FALSE(d.ladder.wants_armed) << "the command is dropped";
    EXPECT_EQ(d.ladder.refusal.order, Refusal::Order::kArm) << "reported until the next command";
  }
}

TEST_F(StepLadder, ArmsWhenNothingForbidsIt) {
  d.in.autopilot_armed = false;
  d.step(0.01, OperatorAction::kArm);
  EXPECT_TRUE(d.ladder.wants_armed) << "immediately if nothing forbids it";
  for (int time = 0; time < 2; ++time) {
    d.in.pose_age_s = d.lim.pose_age_hold_s + 0.01;
    d.wait(1.0);
    EXPECT_FALSE(d.ladder.wants_armed);
    d.in.pose_age_s = 0.0;
    d.wait(d.lim.clear_s - 0.02);
    EXPECT_FALSE(d.ladder.wants_armed);
    d.wait(0.04);
    EXPECT_TRUE(d.ladder.wants_armed);
  }
  // An intermittent condition is never true for arm_wait_s without interruption, so it does not
  // delete the order.
  for (int time = 0; time < 4; ++time) {
    d.in.pose_age_s = d.lim.pose_age_hold_s + 0.01;
    d.wait(0.6 * d.lim.arm_wait_s);
    d.in.pose_age_s = 0.0;
    d.step();
    EXPECT_TRUE(d.ladder.arm.is_given) << time;
  }
}

TEST_F(StepLadder, RevokesOrdersWhenOnlyTheOperatorCanClearTheReason) {
  d.in.autopilot_armed = false;
  for (int time = 0; time < 2; ++time) {
    d.in.poses_rejected = d.lim.pose_rejected_hold;
    d.step(0.01, OperatorAction::kArm);
    EXPECT_FALSE(d.ladder.arm.is_given) << "at once";
    EXPECT_EQ(d.ladder.refusal.order, Refusal::Order::kArm);
    d.in.poses_rejected = 0;
    for (const OperatorAction action : {OperatorAction::kLand, OperatorAction::kHold}) {
      d.step(0.01, OperatorAction::kArm);
      EXPECT_TRUE(d.ladder.arm.is_given);
      EXPECT_EQ(d.ladder.refusal.order, Refusal::Order::kNone);
      d.step(0.01, action);
      EXPECT_FALSE(d.ladder.arm.is_given);
      EXPECT_FALSE(d.ladder.wants_armed);
    }
    d.step(0.01, OperatorAction::kTakeOff);
    EXPECT_EQ(d.ladder.refusal.order, Refusal::Order::kTakeOff) << "`arm` was not sent";
    EXPECT_TRUE(d.ladder.refusal.reasons.none());
    EXPECT_FALSE(d.ladder.take_off.is_given);
  }
}

// A flight has no effect on the next one.
TEST_F(StepLadder, ResetsForEachFlight) {
  for (int flight = 0; flight < 3; ++flight) {
    d.in = {};
    d.in.now += from_seconds(100.0 * (flight + 1));
    EXPECT_EQ(d.airborne(false).ladder.state, FlightState::kHold) << flight;
    EXPECT_EQ(d.wait(1.0), FlightState::kHold) << "`follow` was not sent in this flight";
    EXPECT_EQ(d.step(0.01, OperatorAction::kFollow), FlightState::kFollow);
    d.in.pose_age_s = d.lim.pose_age_land_s + 0.01;
    EXPECT_EQ(d.step(), FlightState::kLand);
    d.in.pose_age_s = 0.0;
    EXPECT_EQ(d.wait(1.0), FlightState::kLand);
    d.in.height_m = 0.0;
    d.step();
    d.in.autopilot_armed = false;
    EXPECT_EQ(d.step(), FlightState::kIdle);
    EXPECT_TRUE(d.ladder.latched.none());
    EXPECT_FALSE(d.ladder.wants_follow);
    EXPECT_FALSE(d.ladder.wants_armed);
    EXPECT_FALSE(d.ladder.arm.is_given);
  }
}

TEST_F(StepLadder, KeepsAnEmergencyStopUntilArmedAgainOnTheGround) {
  d.airborne().in.emergency_stop = true;
  EXPECT_EQ(d.step(), FlightState::kKilled);
  d.in.emergency_stop = false;
  for (const OperatorAction action :
       {OperatorAction::kFollow, OperatorAction::kHold, OperatorAction::kLand,
        OperatorAction::kTakeOff, OperatorAction::kArm}) {
    EXPECT_EQ(d.step(1.0, action), FlightState::kKilled) << "motors still on";
  }
  d.in.autopilot_armed = false;
  d.in.emergency_stop = true;
  EXPECT_EQ(d.step(1.0, OperatorAction::kArm), FlightState::kKilled)
      << "the emergency stop is still requested";
  d.in.emergency_stop = false;
  EXPECT_EQ(d.step(1.0, OperatorAction::kArm), FlightState::kIdle);
  EXPECT_FALSE(d.ladder.wants_armed) << "the first `arm` clears, the second arms";
}

TEST_F(StepLadder, StopsTheMotorsAlsoOnTheGround) {
  d.step(0.01, OperatorAction::kArm);
  EXPECT_TRUE(d.ladder.wants_armed);
  d.in.emergency_stop = true;
  EXPECT_EQ(d.step(), FlightState::kKilled);
  EXPECT_FALSE(d.ladder.wants_armed);
}

TEST_F(StepLadder, KillsABlindVehicleOnlyNearTheFloorOrOutside) {
  d.airborne().in.pose_age_s = 1.6;
  EXPECT_EQ(d.wait(1.0), FlightState::kLand);
  d.in.height_m = 0.1;
  EXPECT_EQ(d.step(), FlightState::kKilled);
}

// For random inputs around their limits, the state has the severity of the worst condition that was
// true.
TEST_F(StepLadder, IsAsSevereAsItsWorstCondition) {
  test::Random random(11);
  for (int trial = 0; trial < 3000; ++trial) {
    d = SteppedLadder();
    d.airborne();
    d.in.pose_age_s = random.coin() ? 0.0 : random.uniform(0.0, 2.0);
    d.in.poses_rejected = random.coin() ? 0 : random.integer(0, 5);
    d.in.tracking_error_m = random.coin() ? 0.0 : random.uniform(0.0, 1.5);
    d.in.fence_now_m = random.uniform(-0.3, 2.0);
    d.in.fence_stop_m = d.in.fence_now_m - random.uniform(0.0, 0.5);
    d.in.separation_now_m = random.uniform(0.4, 3.0);
    d.in.separation_stop_m = d.in.separation_now_m - random.uniform(0.0, 0.5);
    d.in.battery_share = random.uniform(0.0, 1.0);
    d.in.operator_age_s = random.coin() ? 0.0 : random.uniform(0.0, 4.0);
    d.in.heartbeat_age_s = random.coin() ? 0.0 : random.uniform(0.0, 4.0);
    d.in.tilt_rad = random.uniform(0.0, 1.2);
    d.in.estimator_good = random.integer(0, 4) > 0;
    d.wait(4.0);
    int worst = 0;
    for (const Condition& row : conditions()) {
      if (row.holds(d.in, d.lim)) {
        worst = std::max(worst, static_cast<int>(row.severity));
      }
    }
    const int reached = d.ladder.state == FlightState::kFollow   ? 0
                        : d.ladder.state == FlightState::kHold   ? 1
                        : d.ladder.state == FlightState::kLand   ? 2
                        : d.ladder.state == FlightState::kKilled ? 3
                                                                 : -1;
    EXPECT_EQ(reached, worst) << "trial " << trial;
  }
}

// Autopilots stop motors that idle for ten seconds, which would end the order. The ladder therefore
// stops the motors earlier and keeps the order.
TEST_F(StepLadder, LimitsIdlingWhileOtherVehiclesLift) {
  d.in.autopilot_armed = false;
  d.step(0.01, OperatorAction::kArm);
  d.in.autopilot_armed = true;
  d.in.is_lift_blocked = true;
  d.step(0.01, OperatorAction::kTakeOff);
  d.wait(d.lim.lift_idle_s - 0.1);
  EXPECT_TRUE(d.ladder.wants_armed);
  d.wait(30.0);
  EXPECT_FALSE(d.ladder.wants_armed);
  EXPECT_EQ(d.ladder.state, FlightState::kIdle);
  d.in.autopilot_armed = false;
  d.in.is_lift_blocked = false;
  d.step();
  EXPECT_TRUE(d.ladder.wants_armed);
  d.wait(3.0);
  EXPECT_EQ(d.ladder.state, FlightState::kIdle) << "its motors start first";
  d.in.autopilot_armed = true;
  EXPECT_EQ(d.step(), FlightState::kHold);
}

// Regression, seen in a flight: the vehicle's turn began while its idling motors were being
// stopped, so it lifted and fell.
TEST_F(StepLadder, DoesNotLiftWhileMotorsStop) {
  d.in.autopilot_armed = false;
  d.step(0.01, OperatorAction::kArm);
  d.in.autopilot_armed = true;
  d.in.is_lift_blocked = true;
  d.step(0.01, OperatorAction::kTakeOff);
  d.wait(d.lim.lift_idle_s + 0.5);
  ASSERT_FALSE(d.ladder.wants_armed);
  d.in.is_lift_blocked = false;  // the motor stop is not reported yet
  d.wait(0.5);
  EXPECT_EQ(d.ladder.state, FlightState::kIdle);
  d.in.autopilot_armed = false;
  d.wait(1.0);
  EXPECT_TRUE(d.ladder.wants_armed);
  d.in.autopilot_armed = true;
  EXPECT_EQ(d.step(), FlightState::kHold);
}

// Compares the stopping distance after a stop command with that after a loss of commands.
TEST(SafetyLimits, DetermineTheStoppingDistances) {
  const SafetyLimits lim = limits();  // deceleration 2 m/s²
  EXPECT_NEAR(stopping_distance_m(lim, 1.0), 0.20 + 0.25, 1e-12);
  EXPECT_NEAR(stopping_distance_after_loss_m(lim, 1.0), 0.50 + 0.25, 1e-12);
  EXPECT_NEAR(stopping_distance_m(lim, 2.0), 0.40 + 1.00, 1e-12);
}

TEST_F(StepLadder, AllocatesNothing) {
  d.airborne();
  const test::AllocationCounter allocations;
  d.wait(1.0);
  EXPECT_EQ(allocations.count(), 0u);
}

// A healthy vehicle has no condition, and names are unique.
TEST(Conditions, AreFalseForAHealthyVehicleAndHaveUniqueNames) {
  SafetyInputs in;
  in.flight_s = 5.0;
  std::set<std::string> names;
  Severity last = Severity::kKill;
  for (const Condition& row : conditions()) {
    EXPECT_FALSE(row.holds(in, limits())) << row.name;
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_LE(row.severity, last) << row.name << " is out of order";
    EXPECT_GT(std::string(row.limit).size(), 0u);
    EXPECT_GT(std::string(row.clears).size(), 0u);
    last = row.severity;
    const bool is_latched = row.clearing == Clearing::kGround || row.clearing == Clearing::kRearm;
    EXPECT_EQ(is_latched, row.severity >= Severity::kLand) << row.name;
  }
}

TEST(Conditions, OnMessageAgesAreTrueWhenNothingWasReceived) {
  SafetyInputs in;
  in.pose_age_s = in.heartbeat_age_s = in.telemetry_age_s = kNever;
  in.battery_age_s = in.operator_age_s = in.planner_age_s = kNever;
  in.estimator_good = false;
  in.poses_accepted = 0;
  const Reasons blocks = arming_blocks(in, limits());
  const auto rows = conditions();
  std::set<std::string> named;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (blocks[i]) {
      named.insert(rows[i].name);
    }
  }
  for (const char* name : {"pose stale", "pose lost", "pose unsettled", "autopilot quiet",
                           "autopilot lost", "telemetry stale", "battery silent",
                           "estimator failed", "operator quiet", "operator lost"}) {
    EXPECT_TRUE(named.contains(name)) << name;
  }
}

}  // namespace
}  // namespace vantage::drivers
