// Tests the first lift, its supervision, and the climb. Set-points are checked to the centimetre.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "test/drivers/safety/one_vehicle.hpp"

namespace vantage::test {
namespace {

using drivers::FlightSetpoint;
using drivers::PlanVerdict;
using models::FlightState;
using models::OperatorAction;

constexpr double kClimbMps = 0.5;
constexpr double kLiftM = 0.2;

double asked_m(const OneVehicle& one) { return one.out.setpoint.position_world_m.z(); }

// The vehicle climbs at 0.5 m/s to 0.2 m, where its identity is verified, and then to 1 m.
// Set-points lead by 0.1 s. Plans are refused until the vehicle is within 0.15 m of 1 m. A second
// flight gives the same result.
TEST(GuardClimb, ReachesLiftHeightThenFlightHeight) {
  OneVehicle one;
  for (int flight = 0; flight < 2; ++flight) {
    one.begin_lift();
    ASSERT_EQ(one.state(), FlightState::kHold);
    EXPECT_TRUE(one.lifts());
    one.send_command(OperatorAction::kFollow);
    bool may_follow = false;
    double fastest_mps = 0.0;
    double before_m = asked_m(one);
    while (one.position_m.z() < 0.99 && one.ticks < 2000 && !may_follow) {
      EXPECT_NEAR(one.out.climb_to_m, one.lifts() ? kLiftM : 1.0, 1e-9);
      one.tick();
      const double mps = one.out.setpoint.velocity_world_mps.z();
      EXPECT_LE(asked_m(one) - 0.1 * mps, one.out.climb_to_m + 1e-9);
      EXPECT_LE(std::abs(asked_m(one) - before_m), 0.0101 + 0.1 * kClimbMps);
      before_m = asked_m(one);
      fastest_mps = std::max(fastest_mps, mps);
      may_follow = one.follow(0.5, 0.0, 0.2, 1.0) == PlanVerdict::kAccepted;
      EXPECT_EQ(may_follow, one.position_m.z() > 0.85) << one.position_m.z();
    }
    EXPECT_NEAR(fastest_mps, kClimbMps, 1e-9);
    EXPECT_FALSE(one.lifts());
    one.run(0.5);
    EXPECT_EQ(one.state(), FlightState::kFollow);
    EXPECT_NEAR(asked_m(one), 1.0, 1e-6);
    one.send_command(OperatorAction::kLand);
    one.run(5.0);
    EXPECT_LT(one.position_m.z(), 0.06);
    EXPECT_GT(one.position_m.head<2>().norm(), 0.1);
    EXPECT_EQ(one.in().start_off_m, 0.0) << "the vehicle has flown";
    one.position_m.head<2>().setZero();
    one.yaw_rad = 0.0;
    one.drift_mps = Eigen::Vector3d::Zero();
    one.place_on_ground();
    one.run(1.0);
    one.drift_mps.reset();
    ASSERT_EQ(one.state(), FlightState::kIdle);
  }
}

// Heights are measured from the vehicle's ground position, which may be on a table.
TEST(GuardClimb, StartsAtTheGroundHeight) {
  scenario::Scenario room = OneVehicle::room();
  OneVehicle one({0.0, 0.0, 0.0}, 0.0, room);
  one.hold_at_height(0.3);
  one.begin_lift();
  ASSERT_EQ(one.state(), FlightState::kHold);
  EXPECT_NEAR(one.out.climb_to_m, 0.3 + kLiftM, 1e-9);
  EXPECT_NEAR(asked_m(one), 0.3 + 0.01 + 0.1 * kClimbMps, 1e-9);
  // During the climb, any height up to the goal causes no tracking error. Heights below the start
  // or above the goal do.
  EXPECT_NEAR(one.in().tracking_error_m, 0.0, 1e-9);
  for (const double off_m : {-0.2, -0.1, 0.1}) {
    one.hold_at_height(0.3 + off_m);
    one.run(0.4);
    EXPECT_NEAR(one.in().tracking_error_m, std::max(0.0, -off_m), 1e-6) << off_m;
  }
  one.tracks_setpoint = false;
  one.drift_mps = Eigen::Vector3d::Zero();
  one.hold_at_height(0.3 + kLiftM + 0.15);
  one.run(0.4);
  EXPECT_NEAR(one.in().tracking_error_m, std::hypot(0.15, 0.15 * std::sqrt(2.0)), 1e-3)
      << "above, and not at its set-point";
}

// A climb that does not reach its height ends after twice its nominal time plus 5 s. During this
// time the set-point stays at the goal height.
TEST(GuardClimb, EndsAfterItsTimeLimit) {
  OneVehicle one;
  one.hold_at_height(0.3);
  one.begin_lift();
  one.rises = true;
  while (one.lifts() && one.ticks < 1000) {
    one.tick();
  }
  ASSERT_FALSE(one.lifts());
  one.hold_at_height(0.5);
  double climbed_s = 0.0;
  one.run(2.0);
  climbed_s = 2.0;
  EXPECT_NEAR(asked_m(one), 1.0, 1e-6);
  while (one.in().tracking_error_m < 0.4 && climbed_s < 30.0) {
    EXPECT_NEAR(one.in().tracking_error_m, 0.0, 1e-6);
    one.tick();
    climbed_s += OneVehicle::kTickS;
  }
  EXPECT_NEAR(climbed_s, 5.0 + 2.0 * 0.7 / kClimbMps, 0.05);
}

// While another vehicle flies above, the set-point stops and the time limit does not run; then the
// climb continues.
TEST(GuardClimb, PausesBelowAnotherVehicle) {
  OneVehicle one;
  const auto above = [&] { one.others = {one.body("Q2", {0.5, 0.0, 1.2})}; };
  one.begin_lift();
  while (one.lifts() && one.ticks < 1000) {
    one.tick();
  }
  one.run(0.4);
  const double from_m = asked_m(one);
  above();
  one.tick();
  one.run(12.0, [&] {
    above();
    EXPECT_LT(asked_m(one), from_m + 0.02);
    EXPECT_LT(one.in().tracking_error_m, 0.1);
  });
  EXPECT_EQ(one.out.setpoint.velocity_world_mps.z(), 0.0);
  EXPECT_NEAR(one.out.climb_to_m, 1.0, 1e-9);
  // The other vehicle moves away and the climb continues; a hover at the goal height is not a
  // climb.
  double x_m = 0.5;
  one.run(1.2, [&] {
    x_m += 0.01;
    one.others = {one.body("Q2", {x_m, 0.0, 1.2})};
  });
  one.run(2.0, [&] { one.others = {one.body("Q2", {x_m, 0.0, 1.2})}; });
  EXPECT_NEAR(asked_m(one), 1.0, 1e-6);
  one.others = {one.body("Q2", {x_m, 0.0, 1.2})};
  one.hold_at_height(0.7);
  one.run(1.0, [&] { one.others = {one.body("Q2", {x_m, 0.0, 1.2})}; });
  EXPECT_NEAR(asked_m(one), 1.0, 1e-6) << "the set-point is there";
}

// Once the set-point is at the goal height, another vehicle above does not extend the time limit of
// the climb.
TEST(GuardClimb, TimeLimitIsNotExtendedByAVehicleAbove) {
  OneVehicle one;
  const auto fly_above = [&] { one.others = {one.body("Q2", {0.5, 0.0, 1.5})}; };
  one.begin_lift();
  while (one.lifts() && one.ticks < 1000) {
    one.tick();
  }
  one.hold_at_height(0.5);
  one.run(2.0);
  EXPECT_NEAR(asked_m(one), 1.0, 1e-6);
  fly_above();
  one.run(6.5, fly_above);
  EXPECT_NEAR(one.in().tracking_error_m, 0.0, 1e-6);
  one.run(1.0, fly_above);
  EXPECT_NEAR(one.in().tracking_error_m, 0.5, 1e-6);
}

TEST(GuardClimb, IgnoresAVehicleFarAbove) {
  OneVehicle one;
  const auto fly_above = [&] { one.others = {one.body("Q2", {0.5, 0.0, 3.0})}; };
  fly_above();
  one.begin_lift();
  fly_above();
  one.run(4.0, fly_above);
  EXPECT_NEAR(asked_m(one), 1.0, 1e-6);
}

TEST(GuardClimb, VehicleAboveDoesNotPauseALiftOrAPlan) {
  OneVehicle one;
  const auto hover = [&] { one.others = {one.body("Q2", {0.7, 0.0, 0.6})}; };
  hover();
  one.begin_lift();
  one.run(0.2, hover);
  EXPECT_NEAR(one.out.climb_to_m, kLiftM, 1e-9);
  EXPECT_NEAR(asked_m(one), 0.22 * kClimbMps + 0.1 * kClimbMps, 1e-6);
  for (const double height_m : {1.8, 1.2}) {
    OneVehicle other;
    const auto fly_above = [&] { other.others = {other.body("Q2", {0.75, 0.0, 1.9})}; };
    fly_above();
    other.hover_without_plan();
    ASSERT_EQ(other.follow(0.05, 0.0, 1.0, height_m), PlanVerdict::kAccepted);
    fly_above();
    other.run(0.8, fly_above);
    EXPECT_EQ(other.state(), FlightState::kFollow);
    EXPECT_NEAR(asked_m(other), height_m, 1e-6);
  }
}

// A climb is not repeated: a vehicle that is pushed down after its climb has a tracking error.
TEST(GuardClimb, DoesNotResumeAfterItsEnd) {
  OneVehicle one;
  one.begin_lift();
  one.run(4.0);
  EXPECT_NEAR(one.position_m.z(), 1.0, 1e-3);
  one.hold_at_height(0.8);
  one.run(0.4);
  EXPECT_NEAR(one.in().tracking_error_m, 0.2, 1e-6);
}

TEST(GuardClimb, EndsWhenALandingBegins) {
  OneVehicle one;
  one.begin_lift();
  while (one.position_m.z() < 0.6 && one.ticks < 1000) {
    one.tick();
  }
  const auto stand_by = [&] { one.others = {one.body("W1", {0.6, 0.0, 0.05})}; };
  stand_by();
  one.tick();
  one.send_command(OperatorAction::kLand);
  one.tracks_setpoint = false;
  one.tick();
  EXPECT_FALSE(one.out.is_sinking);
  one.hold_at_height(0.4);
  one.run(0.4, stand_by);
  EXPECT_FALSE(one.out.is_sinking);
  const double level_m = (one.position_m.head<2>() - one.setpoint_m()).norm();
  EXPECT_GT(one.in().tracking_error_m, std::hypot(level_m, 0.1)) << "lower than its waiting height";
}

// A plan at another height is flown at that height. The vehicle climbs or descends to it at the
// climb speed, even with a vehicle above. A hover keeps its height.
TEST(GuardClimb, ReachesTheHeightOfThePlan) {
  for (const double height_m : {1.2, 1.8}) {
    OneVehicle one;
    one.hover_without_plan();
    ASSERT_EQ(one.follow(0.5, 0.0, 2.0, height_m, 0.2), PlanVerdict::kAccepted);
    one.run(0.2);
    EXPECT_NEAR(asked_m(one), 1.5, 0.07);
    one.run(0.3);
    EXPECT_EQ(one.state(), FlightState::kFollow);
    EXPECT_NEAR(std::abs(one.out.setpoint.velocity_world_mps.z()), kClimbMps, 1e-6);
    EXPECT_NEAR(std::abs(asked_m(one) - 0.1 * one.out.setpoint.velocity_world_mps.z() - 1.5), 0.15,
                0.021);
    one.run(0.8);
    EXPECT_NEAR(asked_m(one), height_m, 1e-6);
    EXPECT_NEAR(one.out.climb_to_m, height_m, 1e-9);
    one.send_command(OperatorAction::kHold);
    one.run(0.4);
    EXPECT_NEAR(asked_m(one), height_m, 1e-6);
    one.others = {one.body("Q2", {one.position_m.x() + 0.7, one.position_m.y(), height_m + 0.2})};
    one.run(0.4);
    EXPECT_NEAR(asked_m(one), height_m, 1e-6);
  }
}

// Position, velocity, acceleration and yaw of a set-point are consistent. They are the averages of
// the plan over a window that is centred 0.1 s after the current time.
TEST(GuardClimb, SetpointsLeadByATenthOfASecond) {
  OneVehicle one({0.0, 0.0, 1.5});
  one.hover_without_plan();
  ASSERT_EQ(one.follow(0.8, 0.6, 3.0, 1.5), PlanVerdict::kAccepted);
  one.run(1.0);
  for (const double at_s : {1.0, 1.5, 2.0}) {
    const double turned_rad = 0.6 * (at_s + 0.1);
    const FlightSetpoint& commanded = one.out.setpoint;
    EXPECT_EQ(commanded.kind, FlightSetpoint::Kind::kTrack);
    EXPECT_NEAR(commanded.yaw_rad, turned_rad, 1e-3);
    EXPECT_NEAR(commanded.yaw_rate_radps, 0.6, 1e-3);
    const Eigen::Vector2d ahead(std::cos(turned_rad), std::sin(turned_rad));
    const Eigen::Vector2d left(-ahead.y(), ahead.x());
    EXPECT_LT((commanded.velocity_world_mps.head<2>() - 0.8 * ahead).norm(), 0.01);
    EXPECT_LT((commanded.acceleration_world_mps2.head<2>() - 0.8 * 0.6 * left).norm(), 0.01);
    const Eigen::Vector2d place_m =
        0.8 / 0.6 * Eigen::Vector2d(std::sin(turned_rad), 1.0 - std::cos(turned_rad));
    EXPECT_LT((one.setpoint_m() - place_m).norm(), 0.01);
    one.run(0.5);
  }
}

// An idle vehicle gets no set-point, a killed vehicle only the motor stop.
TEST(GuardClimb, SendsNoSetpointWhenIdleOrKilled) {
  OneVehicle one;
  one.place_on_ground();
  one.run(0.2);
  EXPECT_EQ(one.out.setpoint.kind, FlightSetpoint::Kind::kNone);
  EXPECT_EQ(one.out.climb_to_m, 0.0);
  one.send_command(OperatorAction::kEmergencyStop);
  one.tick();
  EXPECT_EQ(one.state(), FlightState::kKilled);
  EXPECT_EQ(one.out.setpoint.kind, FlightSetpoint::Kind::kMotorsOff);
  EXPECT_EQ(one.out.climb_to_m, 0.0) << "no climb was commanded";
  EXPECT_FALSE(one.lifts());
}

// A killed vehicle that is still in the air must not be classified as found flying.
TEST(GuardClimb, DoesNotClassifyAKilledVehicleAsFoundFlying) {
  OneVehicle one;
  one.run(0.2);
  one.send_command(OperatorAction::kEmergencyStop);
  one.run(0.2);
  EXPECT_EQ(one.state(), FlightState::kKilled);
  EXPECT_FALSE(one.in().is_found_flying);
}

// A lift ends when an emergency stop or a landing begins.
TEST(GuardClimb, LiftEndsWithAStopOrLanding) {
  for (const OperatorAction action : {OperatorAction::kEmergencyStop, OperatorAction::kLand}) {
    OneVehicle one;
    one.begin_lift();
    one.run(0.2);
    EXPECT_TRUE(one.lifts());
    one.send_command(action);
    one.tick();
    EXPECT_FALSE(one.lifts()) << static_cast<int>(action);
  }
}

// A plan is accepted while the vehicle follows, and during a hold that lasts only because a plan is
// missing.
TEST(GuardClimb, AcceptsPlansOnlyWhileWaitingForThem) {
  OneVehicle one;
  const auto verdict = [&] { return one.follow(0.2, 0.0, 0.2, 1.5, 0.3); };
  EXPECT_EQ(verdict(), PlanVerdict::kNotFollowing) << "idle";
  one.run(0.2);
  EXPECT_EQ(verdict(), PlanVerdict::kNotFollowing) << "holds without `follow`";
  one.send_command(OperatorAction::kFollow);
  one.tick();
  one.sends_heartbeats = false;
  one.run(1.6);
  EXPECT_EQ(one.state(), FlightState::kHold);
  EXPECT_EQ(verdict(), PlanVerdict::kNotFollowing) << "waits for a heartbeat";
  one.sends_heartbeats = true;
  one.run(0.6);
  EXPECT_EQ(verdict(), PlanVerdict::kAccepted);
  one.run(0.4);
  EXPECT_EQ(one.state(), FlightState::kFollow);
  EXPECT_EQ(verdict(), PlanVerdict::kAccepted) << "the next plan is accepted as well";
  one.send_command(OperatorAction::kHold);
  one.tick();
  EXPECT_EQ(verdict(), PlanVerdict::kNotFollowing);
  one.send_command(OperatorAction::kLand);
  one.tick();
  EXPECT_EQ(verdict(), PlanVerdict::kNotFollowing);
}

}  // namespace
}  // namespace vantage::test
