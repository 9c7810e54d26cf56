// Tests landings of a vehicle that is not seen, or that has an autopilot without a position.

#include <cmath>

#include <gtest/gtest.h>

#include "test/drivers/safety/one_vehicle.hpp"

namespace vantage::test {
namespace {

using drivers::FlightSetpoint;
using models::FlightState;
using models::OperatorAction;

// In a landing, a blind descent by the autopilot begins when its estimator has been bad for 0.2 s.
TEST(LandingUnseen, DescendsBlindlyWhenTheEstimatorFails) {
  OneVehicle one;
  one.begin_landing_at({0.0, 0.0, 1.5});
  for (int time = 0; time < 2; ++time) {
    one.run(0.3);
    EXPECT_EQ(one.out.setpoint.kind, FlightSetpoint::Kind::kTrack);
    one.report.estimator_good = false;
    double doubted_s = 0.0;
    while (one.out.setpoint.kind == FlightSetpoint::Kind::kTrack && doubted_s < 1.0) {
      one.tick();
      doubted_s += OneVehicle::kTickS;
    }
    EXPECT_NEAR(doubted_s, 0.22, 0.021);
    EXPECT_EQ(one.out.setpoint.kind, FlightSetpoint::Kind::kBlindLand);
    EXPECT_EQ(one.out.setpoint.position_world_m.norm(), 0.0) << "no other set-point";
    EXPECT_TRUE(one.out.is_sinking);
    one.report.estimator_good = true;
  }
}

// An unseen vehicle still waits at its hover position after 1.4 s. It descends blindly after 1.5 s,
// even with a body below.
TEST(LandingUnseen, DescendsBlindlyAfterTheTimeLimit) {
  OneVehicle one;
  one.run(0.4);
  one.others = {one.body("W1", {0.1, 0.0, 0.2})};
  one.tick();
  one.has_mocap = false;
  one.tracks_setpoint = false;
  one.sends_telemetry = false;  // the autopilot does not report its height either
  double unseen_s = OneVehicle::kTickS;
  double blind_at_s = 0.0;
  for (; unseen_s < 2.0; unseen_s += OneVehicle::kTickS) {
    one.tick();
    if (one.out.setpoint.kind == FlightSetpoint::Kind::kBlindLand && blind_at_s == 0.0) {
      blind_at_s = unseen_s;
    }
    if (unseen_s < 1.4) {
      EXPECT_FALSE(one.out.is_sinking) << unseen_s;
    }
  }
  EXPECT_NEAR(blind_at_s, 1.53, 0.03);
  EXPECT_TRUE(one.out.is_sinking);
}

// Without a height measurement, the estimated height decreases at 0.4 of the commanded speed and
// stops at the floor.
TEST(LandingUnseen, EstimatesItsHeightWithoutMeasurements) {
  OneVehicle one;
  one.begin_landing_at({0.0, 0.0, 1.5});
  one.run(0.1);
  const double seen_m = one.position_m.z();
  one.has_mocap = false;
  one.run(0.1);
  one.sends_telemetry = false;
  one.run(0.54);
  const double from_m = one.in().height_m;
  EXPECT_NEAR(from_m, seen_m - 0.4 * 0.6 * 0.6, 0.06);
  const double asked_m = one.out.setpoint.position_world_m.z();
  one.run(0.5);
  const double sunk_m = from_m - one.in().height_m;
  EXPECT_NEAR(sunk_m, 0.4 * 0.5 * (asked_m > 1.1 ? 0.6 : 0.4), 0.03);
}

TEST(LandingUnseen, EstimatesNoHeightBelowTheFloor) {
  OneVehicle one;
  one.begin_landing_at({0.0, 0.0, 0.2});
  one.has_mocap = one.sends_telemetry = false;
  double before_m = one.in().height_m;
  one.run(1.44, [&] {
    EXPECT_LE(one.in().height_m, before_m + 1e-6);
    before_m = one.in().height_m;
  });
  EXPECT_EQ(one.in().height_m, 0.0);
  EXPECT_EQ(one.state(), FlightState::kLand);
}

// A vehicle that is unseen for a while descends at its hover position without a search for another
// spot. It waits if a body was last seen below.
TEST(LandingUnseen, DescendsAtItsHoverPosition) {
  for (const bool is_free : {true, false}) {
    OneVehicle one;
    if (!is_free) {
      one.others = {one.body("W1", {0.1, 0.0, 0.2})};
    }
    one.run(0.4, [&] {
      if (!is_free) {
        one.others = {one.body("W1", {0.1, 0.0, 0.2})};
      }
    });
    one.has_mocap = false;
    one.run(0.2);
    one.send_command(OperatorAction::kLand);
    one.run(0.4);
    EXPECT_EQ(one.state(), FlightState::kLand);
    EXPECT_EQ(one.out.is_sinking, is_free);
    EXPECT_EQ(one.out.setpoint.kind, FlightSetpoint::Kind::kTrack);
    EXPECT_LT(one.setpoint_m().norm(), 1e-6);
  }
}

// A pose up to 0.1 s old is fresh enough for the search of a landing spot.
TEST(LandingUnseen, UsesAPoseUpToATenthOfASecondOld) {
  OneVehicle one;
  const auto walker = [&] { one.others = {one.body("W1", {-0.1, 0.0, 0.2})}; };
  walker();
  one.run(0.4, walker);
  one.has_mocap = false;
  one.run(0.02);
  one.send_command(OperatorAction::kLand);
  one.run(0.06);
  EXPECT_GT(one.out.setpoint.velocity_world_mps.head<2>().norm(), 0.05);
}

// A landing known only from the autopilot report starts at the reported height.
TEST(LandingUnseen, StartsAtTheReportedHeight) {
  OneVehicle one({0.0, 0.0, 1.5});
  one.has_mocap = one.report.is_in_our_mode = false;
  one.report.is_landing_itself = true;
  one.run(0.5);
  ASSERT_EQ(one.state(), FlightState::kIdle);
  one.tracks_setpoint = false;
  one.run(0.1);
  EXPECT_EQ(one.state(), FlightState::kLand);
  EXPECT_NEAR(one.out.setpoint.position_world_m.z(), 1.5 - 0.1 * 0.6, 0.07);
}

}  // namespace
}  // namespace vantage::test
