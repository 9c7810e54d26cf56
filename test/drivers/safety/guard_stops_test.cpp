// Tests stops: along the plan while the vehicle tracks it, otherwise straight. Also tests the
// actions that begin at a change of state.

#include <cmath>

#include <gtest/gtest.h>

#include "drivers/safety/course.hpp"
#include "test/drivers/safety/one_vehicle.hpp"

namespace vantage::test {
namespace {

using drivers::PlanVerdict;
using models::FlightState;
using models::OperatorAction;

constexpr double kBrakeMps2 = 2.0;
constexpr double kYawRad = 0.5;

// Returns the point at path length `way_m` of a circle with radius 1 m around (0, 1), from the
// origin eastwards.
Eigen::Vector2d on_circle(double way_m) { return {std::sin(way_m), 1.0 - std::cos(way_m)}; }

void follow_circle(OneVehicle& one, double seconds) {
  one.hover_without_plan();
  ASSERT_EQ(one.follow(1.0, 1.0, 3.0, 1.5), PlanVerdict::kAccepted);
  one.run(seconds);
  ASSERT_EQ(one.state(), FlightState::kFollow);
}

// Rotates a vector by kYawRad, the heading of these tests.
Eigen::Vector3d turned(double on_m, double aside_m) {
  return {on_m * std::cos(kYawRad) - aside_m * std::sin(kYawRad),
          on_m * std::sin(kYawRad) + aside_m * std::cos(kYawRad), 0.0};
}
Eigen::Vector2d back(const Eigen::Vector2d& p_m) {
  return {p_m.x() * std::cos(kYawRad) + p_m.y() * std::sin(kYawRad),
          -p_m.x() * std::sin(kYawRad) + p_m.y() * std::cos(kYawRad)};
}
void follow_straight(OneVehicle& one, double seconds) {
  one.hover_without_plan();
  ASSERT_EQ(one.follow(1.0, 0.0, 3.0, 1.5), PlanVerdict::kAccepted);
  one.run(seconds);
  ASSERT_EQ(one.state(), FlightState::kFollow);
}

// The vehicle stops within v²/2a along the circle; a straight stop would end 3 cm away. The
// predicted braking path also follows the circle.
TEST(GuardStop, FollowsThePlanWhileTracking) {
  for (const double unseen_s : {0.0, 0.04}) {
    OneVehicle one;
    follow_circle(one, 1.0);
    const Eigen::Vector2d stop_m = on_circle(1.0 + 0.2 + 0.25);
    EXPECT_NEAR(one.in().fence_stop_m, 5.0 - 0.25 - std::max(stop_m.x(), stop_m.y()), 0.01);
    one.has_mocap = false;
    one.run(unseen_s);
    one.has_mocap = unseen_s == 0.0;
    one.send_command(OperatorAction::kHold);
    one.tick();
    one.has_mocap = true;
    one.run(1.5);
    EXPECT_EQ(one.state(), FlightState::kHold);
    EXPECT_LT((one.setpoint_m() - on_circle(1.02 + unseen_s + 0.25)).norm(), 0.01);
    EXPECT_NEAR(one.out.setpoint.yaw_rad, 1.02 + unseen_s + 0.25, 0.02);
  }
}

// At an abrupt speed change of the plan, set-points change their speed gradually. The vehicle is
// then up to 0.1 m from its plan and has a different speed. A stop begins at its actual position
// and speed.
TEST(GuardStop, StartsAtActualPositionAndSpeedWhereThePlanChangesAbruptly) {
  for (const double after_s : {0.1, 0.2, 0.3, 1.0, 2.8, 3.0, 3.1}) {
    OneVehicle one({0.0, 0.0, 1.5}, kYawRad);
    follow_straight(one, after_s);
    one.send_command(OperatorAction::kHold);
    one.tick();
    const double speed_mps = one.in().speed_mps;  // estimated value
    const Eigen::Vector2d here_m = one.position_m.head<2>();
    const Eigen::Vector2d velocity_mps = one.out.setpoint.velocity_world_mps.head<2>();
    const Eigen::Vector2d now_m = one.setpoint_m() - one.limits.setpoint_lead_s * velocity_mps;
    EXPECT_LT((now_m - here_m).norm(), 0.03) << after_s;
    EXPECT_LT(velocity_mps.norm(), speed_mps + 0.01) << after_s;
    one.run(1.5);
    const double path_m = back(one.setpoint_m() - here_m).x();
    EXPECT_NEAR(path_m, speed_mps * speed_mps / (2.0 * kBrakeMps2), 0.06) << after_s;
  }
}

// After a loss of poses that is long enough to land, the vehicle stops in a straight line from its
// last accepted position.
TEST(GuardStop, IsStraightAfterALongLoss) {
  OneVehicle one({0.0, 0.0, 1.5}, kYawRad);
  follow_straight(one, 1.0);
  one.drift_mps = turned(1.0, 0.3);
  one.run(0.3);
  const Eigen::Vector2d seen_m = back(one.position_m.head<2>());
  one.has_mocap = false;
  one.now += from_seconds(0.6);  // the driver did not run
  one.tick();
  EXPECT_EQ(one.state(), FlightState::kLand);
  one.run(0.6);
  const double on_s = 0.1 + std::hypot(1.0, 0.3) / (2.0 * kBrakeMps2);
  EXPECT_LT((back(one.setpoint_m()) - seen_m - on_s * Eigen::Vector2d(1.0, 0.3)).norm(), 0.01);
}

// With a velocity error above 0.6 m/s in any direction, the vehicle stops in a straight line. With
// a smaller error the stop follows the plan.
TEST(GuardStop, IsStraightAfterAPush) {
  for (const Eigen::Vector2d& push_mps :
       {Eigen::Vector2d(0.0, 0.5), Eigen::Vector2d(0.0, 0.75), Eigen::Vector2d(0.0, -0.75),
        Eigen::Vector2d(-0.75, 0.0), Eigen::Vector2d(-0.5, 0.0)}) {
    OneVehicle one({0.0, 0.0, 1.5}, kYawRad);
    follow_straight(one, 1.0);
    const Eigen::Vector2d mps = Eigen::Vector2d(1.0, 0.0) + push_mps;
    one.drift_mps = turned(mps.x(), mps.y());
    one.run(0.28);
    one.send_command(OperatorAction::kHold);
    one.tick();
    const Eigen::Vector2d here_m = back(one.position_m.head<2>());
    one.drift_mps.reset();
    one.tracks_setpoint = false;
    one.run(1.0);
    const Eigen::Vector2d way_m = push_mps.norm() < 0.6
                                      ? Eigen::Vector2d(1.0 / (2.0 * kBrakeMps2), 0.0)
                                      : Eigen::Vector2d(mps * mps.norm() / (2.0 * kBrakeMps2));
    EXPECT_LT((back(one.setpoint_m()) - here_m - way_m).norm(), 0.02) << push_mps.transpose();
    EXPECT_NEAR(one.out.setpoint.yaw_rad, kYawRad, 1e-6);
  }
}

// A tracking error above the limit stops the vehicle in a straight line without a command.
TEST(GuardStop, IsStraightBeyondTheTrackingLimit) {
  for (const bool is_far : {false, true}) {
    OneVehicle one({0.0, 0.0, 1.5}, kYawRad);
    follow_straight(one, 0.6);
    one.drift_mps = turned(1.0, 0.3);
    one.run(is_far ? 2.0 : 1.1, [&] {
      if (one.state() == FlightState::kHold) {
        one.drift_mps = Eigen::Vector3d::Zero();
      }
    });
    EXPECT_EQ(one.state(), is_far ? FlightState::kHold : FlightState::kFollow);
    if (!is_far) {
      one.send_command(OperatorAction::kHold);
      one.tick();
      one.drift_mps = Eigen::Vector3d::Zero();
    }
    const double aside_m = back(one.position_m.head<2>()).y();
    EXPECT_GT(aside_m, is_far ? one.limits.tracking_hold_m : 0.3);
    one.run(1.0);
    EXPECT_NEAR(back(one.setpoint_m()).y() - aside_m,
                is_far ? 0.3 * std::hypot(1.0, 0.3) / 4.0 : 0.0, 0.01);
  }
}

// When a vehicle is pushed out of its hover, the predicted braking path follows its measured
// motion.
TEST(GuardStop, PredictsTheBrakingPathOfADriftingHover) {
  for (const bool has_flown_a_plan : {false, true}) {
    OneVehicle one({0.0, 0.0, 1.5}, kYawRad);
    if (has_flown_a_plan) {
      follow_straight(one, 1.0);
      one.send_command(OperatorAction::kHold);
    }
    one.run(1.5);
    one.drift_mps = Eigen::Vector3d(0.4, 0.0, 0.0);
    one.run(0.4);
    EXPECT_NEAR(one.in().fence_stop_m,
                5.0 - 0.25 - (one.position_m.x() + 0.4 * 0.2 + 0.4 * 0.4 / (2.0 * kBrakeMps2)),
                0.002);
  }
}

// A vehicle that has just begun a plan may be much slower than the plan. If the commanded speed
// exceeds twice the vehicle's speed by more than 0.1 m/s, the vehicle stops at its position and
// does not continue the plan.
TEST(GuardStop, StopsAtItsPositionWhenThePlanHasJustBegun) {
  struct Case {
    double own_mps, asked_mps;
    bool continues_plan;
  };
  for (const Case& c : {Case{0.0, 0.09, true}, Case{0.0, 0.11, false}, Case{0.3, 0.68, true},
                        Case{0.3, 0.72, false}, Case{0.2, 0.48, true}, Case{0.2, 0.52, false}}) {
    OneVehicle one({0.0, 0.0, 1.5}, kYawRad);
    one.hover_without_plan();
    one.drift_mps = turned(c.own_mps, 0.0);
    one.run(0.4);
    // 0.26 s after its start, the plan covers the whole averaging window of 0.5 s.
    ASSERT_EQ(one.follow(c.asked_mps, 0.0, 2.0, 1.5), PlanVerdict::kAccepted);
    one.run(0.24);
    ASSERT_EQ(one.state(), FlightState::kFollow);
    one.send_command(OperatorAction::kHold);
    one.tick();
    ASSERT_EQ(one.state(), FlightState::kHold);
    const double here_m = back(one.position_m.head<2>()).x();
    one.drift_mps.reset();
    one.tracks_setpoint = false;
    one.run(1.0);
    const double off_m = back(one.setpoint_m()).x() - here_m - c.own_mps * c.own_mps / 4.0;
    EXPECT_EQ(std::abs(off_m) > 2e-4, c.continues_plan)
        << c.own_mps << " " << c.asked_mps << " " << off_m;
  }
}

// The predicted braking path follows a plan that has just begun.
TEST(GuardStop, PredictsTheBrakingPathAlongANewPlan) {
  OneVehicle one;
  one.hover_without_plan();
  one.tracks_setpoint = false;
  ASSERT_EQ(one.follow(1.0, 0.0, 2.0, 1.5), PlanVerdict::kAccepted);
  one.run(0.04);
  ASSERT_EQ(one.state(), FlightState::kFollow);
  EXPECT_NEAR(one.in().fence_stop_m, 5.0 - 0.25 - 0.2 - 0.25, 0.06);
}

// The final hover of a plan was checked together with the plan, so the vehicle hovers there
// regardless of its actual position. If a further plan was accepted, the vehicle stops from its
// actual position.
TEST(GuardStop, HoversAtTheEndOfThePlan) {
  for (const bool has_next : {false, true}) {
    OneVehicle one({0.0, 0.0, 1.5}, kYawRad);
    one.hover_without_plan();
    ASSERT_EQ(one.follow(0.5, 0.0, 1.0, 1.5), PlanVerdict::kAccepted);
    one.run(1.6);
    const Eigen::Vector2d end_m = turned(0.5 + 0.5 * 0.5 / 4.0, 0.0).head<2>();
    EXPECT_LT((one.setpoint_m() - end_m).norm(), 1e-6);
    one.drift_mps = turned(0.0, 0.5);
    one.run(0.2);
    one.drift_mps = Eigen::Vector3d::Zero();
    one.run(0.4);
    ASSERT_EQ(one.state(), FlightState::kFollow);
    if (has_next) {
      ASSERT_EQ(one.follow(0.5, 0.0, 1.0, 1.5, 0.6), PlanVerdict::kAccepted);
    }
    one.send_command(OperatorAction::kHold);
    one.run(0.6);
    EXPECT_EQ(one.state(), FlightState::kHold);
    const Eigen::Vector2d stop_m = has_next ? Eigen::Vector2d(one.position_m.head<2>()) : end_m;
    EXPECT_LT((one.setpoint_m() - stop_m).norm(), 1e-3) << has_next;
    EXPECT_NEAR(one.out.setpoint.yaw_rad, kYawRad, 1e-6);
  }
}

// A stop in the middle of a plan starts at the actual position.
TEST(GuardStop, StartsAtTheActualPositionWithinAPlan) {
  OneVehicle one({0.0, 0.0, 1.5}, kYawRad);
  follow_straight(one, 1.0);
  const double here_m = back(one.position_m.head<2>()).x();
  one.send_command(OperatorAction::kLand);
  one.run(0.3);
  EXPECT_EQ(one.state(), FlightState::kLand);
  EXPECT_GT(one.out.setpoint.velocity_world_mps.norm(), 0.1) << "still braking";
  one.run(0.7);
  EXPECT_NEAR(back(one.setpoint_m()).x() - here_m, 0.02 + 0.25, 0.01);
  EXPECT_LT(one.out.setpoint.velocity_world_mps.head<2>().norm(), 1e-9);
}

// A plan accepted during a hold is dropped when a landing begins, and the hover position is kept.
TEST(GuardStop, DropsAnAcceptedPlanWhenLanding) {
  OneVehicle one({0.0, 0.0, 1.5}, kYawRad);
  one.hover_without_plan();
  ASSERT_EQ(one.follow(1.0, 0.0, 3.0, 1.5), PlanVerdict::kAccepted);
  ASSERT_EQ(one.state(), FlightState::kHold);
  one.send_command(OperatorAction::kLand);
  one.run(1.5);
  EXPECT_EQ(one.state(), FlightState::kLand);
  EXPECT_LT(one.setpoint_m().norm(), 0.01);
}

TEST(GuardStop, KeepsTheHoverWhenLanding) {
  OneVehicle one({0.3, -0.4, 1.5}, kYawRad);
  one.run(0.2);
  one.tracks_setpoint = false;
  one.drift_mps = Eigen::Vector3d(0.3, 0.0, 0.0);
  one.run(0.4);
  one.drift_mps = Eigen::Vector3d::Zero();
  one.run(0.4);
  one.send_command(OperatorAction::kLand);
  one.run(0.5);
  EXPECT_LT((one.setpoint_m() - Eigen::Vector2d(0.3, -0.4)).norm(), 1e-6);
}

// The flight time counts in all airborne states and restarts at 0 in the next flight.
TEST(GuardStop, FlightTimeContinuesInAllAirborneStates) {
  OneVehicle one;
  one.tick();
  double flown_s = 0.0;
  const auto run_for = [&](double seconds, FlightState state) {
    one.run(seconds);
    flown_s += seconds;
    EXPECT_EQ(one.state(), state);
    EXPECT_NEAR(one.in().flight_s, flown_s, 1e-6);
  };
  run_for(0.4, FlightState::kHold);
  one.send_command(OperatorAction::kFollow);
  run_for(0.1, FlightState::kHold);
  ASSERT_EQ(one.follow(0.5, 0.0, 2.0, 1.5), PlanVerdict::kAccepted);
  run_for(0.4, FlightState::kFollow);
  one.send_command(OperatorAction::kHold);
  run_for(0.4, FlightState::kHold);
  one.send_command(OperatorAction::kLand);
  run_for(0.4, FlightState::kLand);
}

// A pose up to 0.05 s old is fresh enough for a motion away from the fence.
TEST(GuardStop, MovesAwayFromTheFenceWithASlightlyOldPose) {
  OneVehicle one({5.0 - 0.25 - 0.05, 1.0, 1.5});
  one.report.armed = one.sends_heartbeats = false;
  one.run(0.1);
  one.has_mocap = false;
  one.report.armed = one.sends_heartbeats = true;
  one.tick();
  ASSERT_EQ(one.state(), FlightState::kHold);
  one.has_mocap = true;
  one.tick();
  // The shift began one tick (0.02 s) ago, so the set-point, which leads by 0.1 s, has the velocity
  // of 0.12 s after its start.
  EXPECT_GT(one.out.setpoint.velocity_world_mps.head<2>().norm(), 0.2 * 0.11 / 0.5);
}

// A hover closer than 0.1 m to the fence moves away at 0.2 m/s to a distance of 0.15 m. It does not
// move while poses are old or the estimator is bad.
TEST(GuardStop, MovesAwayFromTheFence) {
  enum class Waits { kNot, kForMocap, kForEstimator };
  for (const Waits waits : {Waits::kNot, Waits::kForMocap, Waits::kForEstimator}) {
    OneVehicle one({5.0 - 0.25 - 0.05, 1.0, 1.5});
    const auto is_off = [&] { return 5.0 - 0.25 - one.setpoint_m().x() > 0.0501; };
    if (waits == Waits::kForMocap) {
      one.report.armed = one.sends_heartbeats = false;
      one.tick();
      one.has_mocap = false;
      one.run(0.04);
      one.report.armed = one.sends_heartbeats = true;
    }
    one.report.estimator_good = waits != Waits::kForEstimator;
    one.run(waits == Waits::kForMocap ? 0.04 : 0.6, [&] {
      if (waits != Waits::kNot) {
        EXPECT_FALSE(is_off());
      }
    });
    EXPECT_EQ(one.state(), FlightState::kHold);
    one.has_mocap = one.report.estimator_good = true;
    double fastest_mps = 0.0;
    one.run(waits == Waits::kNot ? 1.0 : 1.6, [&] {
      fastest_mps = std::max(fastest_mps, one.out.setpoint.velocity_world_mps.head<2>().norm());
    });
    EXPECT_NEAR(fastest_mps, 0.2, 0.01);
    EXPECT_NEAR(5.0 - 0.25 - one.setpoint_m().x(), 0.15, 0.051);
    EXPECT_GE(5.0 - 0.25 - one.setpoint_m().x(), 0.15 - 1e-9);
  }
}

}  // namespace
}  // namespace vantage::test
