#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "drivers/safety/surroundings.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/support/bisect.hpp"

// Tests of bodies that are not robots of the scenario: they do not brake, they reach down to the
// ground, and landings predict their motion.

namespace vantage::drivers {
namespace {

SafetyLimits bench_limits() { return limits_for(test::FlightBench::scenario(), "Q1"); }

const Eigen::Vector3d kHere_m(0.0, -1.0, 1.0);

OtherBody person_at(double ahead_m, double speed_mps, double above_m = 0.0) {
  OtherBody body;
  body.position_world_m = kHere_m + Eigen::Vector3d(ahead_m, 0.0, above_m);
  body.velocity_world_mps = body.planned_world_mps = {speed_mps, 0.0, 0.0};
  body.last_speed_mps = std::abs(speed_mps);
  return body;
}

double stop_m(const OtherBody& body, double own_mps, const SafetyLimits& limits) {
  const BrakingPath way = BrakingPath::straight(kHere_m, {own_mps, 0.0, 0.0}, 0.0,
                                                limits.vehicle.brake_mps2, limits.reaction_s);
  return compute_surroundings(kHere_m, way, {&body, 1}, limits).separation_stop_m;
}

// A person walks head-on towards the vehicle. The predicted distance is reduced by three amounts:
// the vehicle's stopping distance v T + v²/2a, the person's path at constant speed, and the
// greatest deviation of the person from that straight path.
TEST(ComputeSurroundings, PredictsAPersonUntilTheVehicleStops) {
  const SafetyLimits limits = bench_limits();
  for (const double own_mps : {0.0, 0.5, 1.0}) {
    for (const double person_mps : {0.0, 0.5, 1.0, 1.5}) {
      const double stands_s = limits.reaction_s + own_mps / limits.vehicle.brake_mps2;
      const double left_m = 3.0 - stopping_distance_m(limits, own_mps) - person_mps * stands_s -
                            0.5 * limits.other_turn_mps2 * stands_s * stands_s;
      EXPECT_NEAR(stop_m(person_at(3.0, -person_mps), own_mps, limits), left_m, 1e-9)
          << own_mps << ' ' << person_mps;
    }
  }
}

TEST(ComputeSurroundings, UsesTheDecelerationOfARobot) {
  const SafetyLimits limits = bench_limits();
  for (const double brake_mps2 : {0.5, 2.0, 4.0}) {
    OtherBody body = person_at(3.0, -1.0);
    body.robot = 1;
    body.brake_mps2 = brake_mps2;
    EXPECT_NEAR(stop_m(body, 0.0, limits), 3.0 - limits.reaction_s - 0.5 / brake_mps2, 1e-9);
    body.brake_mps2 = 0.0;  // 0: deceleration unknown, assumed equal to the vehicle's own
    EXPECT_NEAR(stop_m(body, 0.0, limits), 3.0 - stopping_distance_m(limits, 1.0), 1e-9);
  }
}

// A person extends from the markers down to the ground; a rover on the floor is entirely below the
// vehicle.
TEST(ComputeSurroundings, TreatsAPersonAsReachingTheGround) {
  const SafetyLimits limits = bench_limits();
  const double at_rest_m = 0.5 * limits.other_turn_mps2 * limits.reaction_s * limits.reaction_s;
  for (const double above_m : {0.0, 0.3, 0.8}) {
    EXPECT_NEAR(stop_m(person_at(0.9, 0.0, above_m), 0.0, limits), 0.9 - at_rest_m, 1e-9);
  }
  for (const double speed_mps : {0.0, 1.4}) {
    for (const double ahead_m : {-0.5, 0.0, 0.5}) {
      EXPECT_GE(stop_m(person_at(ahead_m, speed_mps, -0.8), 1.0, limits), 0.8);
    }
  }
}

// Until the vehicle has stopped, a person that mocap has lost may move in any direction at the last
// speed.
TEST(ComputeSurroundings, AssumesAnOccludedPersonKeepsWalking) {
  const SafetyLimits limits = bench_limits();
  for (const double unseen_s : {0.1, 0.5, 0.9}) {
    OtherBody body = person_at(4.0, 0.0);
    body.last_speed_mps = 1.5;
    body.age_s = limits.pose_age_hold_s + unseen_s;
    const double stands_s = limits.reaction_s + 1.0 / limits.vehicle.brake_mps2;
    const double left_m = 4.0 - stopping_distance_m(limits, 1.0) - 1.5 * (unseen_s + stands_s) -
                          0.5 * limits.other_turn_mps2 * stands_s * stands_s;
    EXPECT_NEAR(stop_m(body, 1.0, limits), left_m, 1e-9) << unseen_s;
  }
}

// A person counts as below if the person will be below before touchdown, within
// descent_prediction_s.
TEST(OccupiedBelow, PredictsAPerson) {
  const SafetyLimits limits = bench_limits();
  for (const double height_m : {0.2, 0.4, 1.0, 2.0}) {
    const Eigen::Vector3d hover_m(0.0, -1.0, height_m);
    const double down_s = height_m / limits.low_descent_mps;
    for (const double speed_mps : {0.0, 0.5, 1.5}) {
      const double nearest_m = test::last_accepted(5.0, 0.0, 1e-9, [&](double x_m) {
        OtherBody body;
        body.position_world_m = {x_m, -1.0, 0.0};
        body.velocity_world_mps = {-speed_mps, 0.0, 0.0};
        return !is_occupied_below(hover_m, {&body, 1}, limits);
      });
      EXPECT_NEAR(
          nearest_m,
          limits.landing_clearance_m + speed_mps * std::min(down_s, limits.descent_prediction_s),
          1e-7)
          << height_m << ' ' << speed_mps;
    }
  }
}

// A person 1.5 m away walks under the vehicle. The landing spot must be neither on the person's
// path nor at its end.
TEST(LandingSpot, AvoidsThePathOfAPerson) {
  const SafetyLimits limits = bench_limits();
  const Eigen::Vector3d hover_m(2.0, -0.5, 1.0);
  OtherBody body;
  body.position_world_m = {0.5, -0.5, 0.0};
  body.velocity_world_mps = {1.2, 0.0, 0.0};
  const Eigen::Vector3d spot_m = landing_spot(hover_m, {&body, 1}, limits);
  EXPECT_NE(spot_m, hover_m);
  EXPECT_GE(std::abs(spot_m.y() - hover_m.y()), limits.landing_clearance_m);
  body.velocity_world_mps.setZero();
  EXPECT_EQ(landing_spot(hover_m, {&body, 1}, limits), hover_m);
}

// A person whose path crosses the vehicle's path during the motion blocks that path.
TEST(IsPathBlocked, CountsACrossingPerson) {
  const SafetyLimits limits = bench_limits();
  const Eigen::Vector3d from_m(0.0, 0.0, 1.0);
  const Eigen::Vector3d to_m(1.2, 0.0, 1.0);  // takes 2 s
  OtherBody body;
  body.position_world_m = {0.6, 1.0, 1.0};
  EXPECT_FALSE(is_path_blocked(from_m, to_m, {&body, 1}, limits));
  body.velocity_world_mps = {0.0, -1.0, 0.0};
  EXPECT_TRUE(is_path_blocked(from_m, to_m, {&body, 1}, limits));
  body.velocity_world_mps = {0.0, 1.0, 0.0};
  EXPECT_FALSE(is_path_blocked(from_m, to_m, {&body, 1}, limits));
}

}  // namespace
}  // namespace vantage::drivers
