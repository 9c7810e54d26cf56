// Tests the responses of the guard to commands on the ground and in the air, and the wait of a
// take-off for its turn.

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/drivers/safety/one_vehicle.hpp"

namespace vantage::test {
namespace {

using drivers::CommandVerdict;
using models::FlightState;
using models::OperatorAction;

constexpr OperatorAction kAll[] = {OperatorAction::kHeartbeat,    OperatorAction::kArm,
                                   OperatorAction::kTakeOff,      OperatorAction::kFollow,
                                   OperatorAction::kHold,         OperatorAction::kLand,
                                   OperatorAction::kEmergencyStop};

/// Returns the response of a new vehicle to one command, so that earlier commands have no effect.
CommandVerdict answer(bool is_airborne, OperatorAction action, const std::string& addressee,
                      std::int64_t station) {
  OneVehicle q1;
  if (!is_airborne) {
    q1.place_on_ground();
  }
  q1.run(0.1);
  EXPECT_EQ(q1.out.state, is_airborne ? FlightState::kHold : FlightState::kIdle);
  const std::int64_t refused = q1.count("command.refused");
  const CommandVerdict verdict = q1.send_command_to(addressee, action, station);
  // Commands for other vehicles and heartbeats are not counted as refused.
  const bool counts =
      verdict == CommandVerdict::kRefused ||
      (verdict == CommandVerdict::kNotInCharge && action != OperatorAction::kHeartbeat);
  EXPECT_EQ(q1.count("command.refused") - refused, counts ? 1 : 0) << static_cast<int>(action);
  return verdict;
}

// Arm and take-off are accepted on the ground only, follow in the air only.
TEST(GuardOrders, AreRefusedInTheWrongState) {
  for (const bool is_airborne : {false, true}) {
    for (const OperatorAction action : kAll) {
      const bool is_for_ground =
          action == OperatorAction::kArm || action == OperatorAction::kTakeOff;
      const bool is_for_air = action == OperatorAction::kFollow;
      const bool makes_sense = is_airborne ? !is_for_ground : !is_for_air;
      const CommandVerdict due = makes_sense ? CommandVerdict::kObeyed : CommandVerdict::kRefused;
      for (const char* const addressee : {"", "Q1"}) {
        EXPECT_EQ(answer(is_airborne, action, addressee, 7), due) << static_cast<int>(action);
      }
      EXPECT_EQ(answer(is_airborne, action, "Q2", 7), CommandVerdict::kOtherRobot);
    }
  }
}

// Commands that make the vehicle safer are accepted from any station, all others only from the
// station in charge. Commands for another vehicle are ignored.
TEST(GuardOrders, AreAcceptedFromTheStationInCharge) {
  for (const bool is_airborne : {false, true}) {
    for (const OperatorAction action : kAll) {
      const CommandVerdict due =
          models::makes_safer(action) ? CommandVerdict::kObeyed : CommandVerdict::kNotInCharge;
      EXPECT_EQ(answer(is_airborne, action, "Q1", 8), due) << static_cast<int>(action);
      EXPECT_EQ(answer(is_airborne, action, "Q2", 8), CommandVerdict::kOtherRobot);
    }
  }
}

// Another station takes charge when the first has been silent for the time limit. Both sides of the
// limit are tested.
TEST(GuardOrders, AreAcceptedFromAnotherStationAfterSilence) {
  for (const double off_s : {-0.01, 0.01}) {
    OneVehicle q1;
    q1.place_on_ground();
    q1.run(0.1);
    q1.send_command(OperatorAction::kHeartbeat);
    q1.now += from_seconds(q1.limits.operator_age_hold_s + off_s);
    const CommandVerdict verdict = q1.send_command_to("", OperatorAction::kHeartbeat, 8);
    EXPECT_EQ(verdict, off_s > 0.0 ? CommandVerdict::kObeyed : CommandVerdict::kNotInCharge);
    EXPECT_EQ(q1.count("operator.handovers"), off_s > 0.0 ? 1 : 0);
  }
}

// A take-off waits for the motors and then for the vehicle that is lifting. The status shows each
// reason.
TEST(GuardOrders, ReportWhatATakeOffWaitsFor) {
  OneVehicle q1;
  q1.place_on_ground();
  q1.run(1.2);
  EXPECT_EQ(q1.send_command_to("", OperatorAction::kArm), CommandVerdict::kObeyed);
  q1.tick();
  EXPECT_EQ(q1.reasons(), std::vector<std::string>());
  EXPECT_EQ(q1.send_command_to("Q1", OperatorAction::kTakeOff), CommandVerdict::kObeyed);
  q1.tick();
  EXPECT_EQ(q1.reasons(), std::vector<std::string>({"take-off pending: starting the motors"}));
  models::VehicleStatus q2;
  q2.robot = "Q2";
  q2.state = FlightState::kHold;
  q2.reasons = {"first lift"};
  q1.guard.on_teammate_status(q2, q1.now);
  q1.report.armed = q1.report.is_in_our_mode = true;
  q1.tick();
  EXPECT_TRUE(q1.out.changed);
  const std::vector<std::string> waits = {"another vehicle is lifting", "take-off pending"};
  EXPECT_EQ(q1.reasons(), waits);
  q1.tick();
  EXPECT_FALSE(q1.out.changed);
  EXPECT_EQ(q1.reasons(), waits);
  EXPECT_EQ(q1.out.state, FlightState::kIdle);
}

// A teammate counts as lifting while it is airborne and reports its lift, for a limited time.
TEST(GuardOrders, WaitForATeammateThatReportsItsLift) {
  for (const FlightState state : {FlightState::kIdle, FlightState::kFollow, FlightState::kHold,
                                  FlightState::kLand, FlightState::kKilled}) {
    for (const bool says_so : {true, false}) {
      OneVehicle q1;
      q1.place_on_ground();
      q1.run(0.1);
      models::VehicleStatus q2;
      q2.robot = "Q2";
      q2.state = state;
      q2.reasons = {"no plan"};
      if (says_so) {
        q2.reasons.emplace_back("first lift");
      }
      q1.guard.on_teammate_status(q2, q1.now);
      q1.tick();
      const bool lifts = says_so && drivers::is_airborne(state);
      EXPECT_EQ(q1.guard.inputs().is_lift_blocked, lifts) << models::name_of(state);
      q1.run(1.0);
      EXPECT_FALSE(q1.guard.inputs().is_lift_blocked);
    }
  }
}

// Two vehicles get their take-off orders simultaneously. The first by name lifts, and its turn ends
// when its lift ends.
TEST(GuardOrders, TurnEndsWhenTheLiftEnds) {
  OneVehicle q1;
  q1.place_on_ground();
  q1.fastest_mps = 1.0;
  q1.fastest_radps = 0.4;
  q1.run(1.2);
  EXPECT_EQ(q1.send_command_to("", OperatorAction::kArm), CommandVerdict::kObeyed);
  q1.tick();
  ASSERT_TRUE(q1.out.wants_armed);
  q1.report.armed = q1.report.is_in_our_mode = true;
  q1.run(0.3);
  EXPECT_EQ(q1.send_command_to("", OperatorAction::kTakeOff), CommandVerdict::kObeyed);
  int lifting = 0;
  for (q1.tick(); lifting < 250 && q1.has_reason("first lift"); q1.tick()) {
    EXPECT_EQ(q1.out.state, FlightState::kHold);
    EXPECT_FALSE(q1.guard.inputs().is_lift_blocked) << "its own turn";
    EXPECT_NEAR(q1.out.climb_to_m, q1.limits.lift_height_m, 1e-6);
    ++lifting;
  }
  EXPECT_GT(lifting, 20);
  EXPECT_LT(lifting, 250);
  ASSERT_EQ(q1.out.state, FlightState::kHold);
  q1.run(0.1);
  EXPECT_TRUE(q1.guard.inputs().is_lift_blocked) << "Q2 was commanded as well";
  EXPECT_EQ(q1.out.climb_to_m, q1.limits.take_off_height_m);
  q1.run(3.0);
  EXPECT_NEAR(q1.position_m.z(), q1.limits.take_off_height_m, 1e-3);
  for (const models::NamedCount& each : q1.guard.counters()) {
    EXPECT_EQ(each.count, 0) << each.name << ": nothing was refused or dropped";
  }
}

// A wrong map is reported until the right one is announced. Another software version is reported
// for a limited time.
TEST(GuardOnTheGround, ReportsAnotherMapOrVersion) {
  OneVehicle q1;
  q1.place_on_ground();
  q1.run(1.2);
  for (int time = 0; time < 2; ++time) {  // repeated with the same guard
    EXPECT_EQ(q1.reasons(), std::vector<std::string>());
    q1.guard.on_map(false);
    q1.tick();
    EXPECT_TRUE(q1.guard.inputs().map_differs);
    EXPECT_EQ(q1.reasons(), std::vector<std::string>({"map differs"}));
    EXPECT_TRUE(q1.out.changed);
    q1.tick();
    EXPECT_FALSE(q1.out.changed);
    q1.guard.on_map(true);
    q1.tick();
    EXPECT_FALSE(q1.guard.inputs().map_differs);
    EXPECT_TRUE(q1.out.changed);
  }
  EXPECT_EQ(q1.guard.inputs().other_version_age_s, drivers::kNever);
  for (int time = 0; time < 2; ++time) {
    q1.guard.on_other_version(q1.now);
    q1.run(0.3);
    EXPECT_NEAR(q1.guard.inputs().other_version_age_s, 0.3, 1e-9);
    EXPECT_EQ(q1.reasons(), std::vector<std::string>({"another version"}));
  }
}

// Finite numbers of any size are accepted.
TEST(AutopilotReport, IsAcceptedWithLargeValues) {
  OneVehicle q1;
  q1.place_on_ground();
  drivers::AutopilotReport report;
  report.has_attitude = true;
  report.tilt_rad = report.yaw_rate_radps = std::numeric_limits<double>::max();
  q1.guard.on_autopilot(report, q1.now);
  (void)q1.guard.tick(q1.now);
  EXPECT_EQ(q1.guard.inputs().tilt_rad, report.tilt_rad);
  EXPECT_EQ(q1.count("autopilot.refused"), 0);
}

}  // namespace
}  // namespace vantage::test
