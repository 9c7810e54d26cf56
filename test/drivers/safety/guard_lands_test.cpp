// Tests landings: landing position, descent speed, and waiting for bodies below. Several tests
// perform two flights with the same guard.

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/safety/surroundings.hpp"
#include "test/drivers/safety/one_vehicle.hpp"

namespace vantage::test {
namespace {

using drivers::FlightSetpoint;
using models::FlightState;
using models::OperatorAction;

// The vehicle descends at 0.6 m/s above 1 m and at 0.4 m/s below.
TEST(Landing, DescendsAtTwoSpeeds) {
  OneVehicle one;
  for (int flight = 0; flight < 2; ++flight) {  // second flight with the same guard
    one.begin_landing_at({0.5, -0.5, 2.0});
    EXPECT_TRUE(one.out.is_sinking);
    EXPECT_LT(one.out.climb_to_m, 0.0);
    EXPECT_GE(one.out.climb_to_m, -1.0);
    double before_m = one.out.setpoint.position_world_m.z();
    while (one.position_m.z() > 0.02) {
      one.tick();
      const double asked_m = one.out.setpoint.position_world_m.z();
      const double ref_m = asked_m - 0.1 * one.out.setpoint.velocity_world_mps.z();
      const double mps = ref_m > 1.02 ? 0.6 : 0.4;
      if (std::abs(ref_m - 1.0) > 0.03 && ref_m > 0.05) {
        EXPECT_NEAR(one.out.setpoint.velocity_world_mps.z(), -mps, 1e-6) << ref_m;
        EXPECT_NEAR(before_m - asked_m, mps * 0.02, 1e-6);
      }
      EXPECT_LT((one.setpoint_m() - Eigen::Vector2d(0.5, -0.5)).norm(), 1e-6);
      EXPECT_LT(one.in().tracking_error_m, 0.01);
      before_m = asked_m;
    }
    EXPECT_FALSE(one.out.wants_armed);
    one.finish_landing();
  }
}

// The set-point descends until touchdown but stays at most 0.5 m below the vehicle.
TEST(Landing, SetpointIsAtMostHalfAMetreBelow) {
  for (const double held_m : {0.3, 1.8}) {
    OneVehicle one;
    one.begin_landing_at({0.0, 0.0, 2.0});
    one.run(held_m < 1.0 ? 3.5 : 0.1);
    one.hold_at_height(held_m);
    one.run(2.2);  // s; short, because a longer descent would trigger the check for sinking
    EXPECT_NEAR(one.out.setpoint.position_world_m.z(), held_m - 0.5, 1e-6);
    EXPECT_NEAR(one.out.setpoint.velocity_world_mps.z(), 0.0, 1e-6);
  }
}

// A landing that begins during a climb starts at the lower of set-point and position.
TEST(Landing, StartsAtTheLowerOfPositionAndSetpoint) {
  for (const double off_m : {-0.3, 0.3}) {
    OneVehicle one;
    one.position_m.z() = 1.5;
    one.run(0.4);
    one.tracks_setpoint = false;
    one.drift_mps = Eigen::Vector3d(0.0, 0.0, off_m);
    one.run(1.0);
    one.drift_mps = Eigen::Vector3d::Zero();
    one.run(0.1);
    one.send_command(OperatorAction::kLand);
    one.tick();
    const double from_m = 1.5 + std::min(0.0, off_m);
    EXPECT_NEAR(one.out.setpoint.position_world_m.z(), from_m - 0.6 * 0.12, 0.001);
  }
}

// A vehicle that is pushed up while its landing waits keeps its set-point height. An earlier
// landing without a wait changes nothing.
TEST(Landing, WaitsAtTheSetpointHeightAfterAPushUp) {
  OneVehicle one;
  one.begin_landing_at({0.0, 0.0, 1.5});
  one.run(0.5);
  EXPECT_TRUE(one.out.is_sinking);
  one.finish_landing();
  const auto walker = [&] { one.others = {one.body("W1", {0.1, 0.0, 0.2})}; };
  one.position_m = {0.0, 0.0, 1.5};
  one.report.armed = true;
  walker();
  one.run(0.4, walker);
  one.drift_mps = Eigen::Vector3d(0.0, 0.0, 0.3);
  one.run(1.0, walker);
  one.drift_mps = Eigen::Vector3d::Zero();
  one.send_command(OperatorAction::kLand);
  one.run(0.1, walker);
  EXPECT_EQ(one.state(), FlightState::kLand);
  EXPECT_FALSE(one.out.is_sinking);
  EXPECT_NEAR(one.out.setpoint.position_world_m.z(), 1.5, 1e-3);
}

// With a body below, the vehicle first moves aside at 0.6 m/s and then descends. The second flight
// does the same.
TEST(Landing, MovesAsideFromABodyBelow) {
  OneVehicle one;
  for (int flight = 0; flight < 2; ++flight) {
    const Eigen::Vector3d from_m(0.5, -0.5 + flight, 1.5);
    const Eigen::Vector3d walker_m = from_m - Eigen::Vector3d(0.1, 0.0, 1.2);
    one.others = {one.body("W1", walker_m)};
    one.begin_landing_at(from_m);
    EXPECT_FALSE(one.out.is_sinking);
    double fastest_mps = 0.0;
    for (int i = 0; i < 400 && one.position_m.z() > 0.02; ++i) {
      one.others = {one.body("W1", walker_m)};
      one.tick();
      fastest_mps = std::max(fastest_mps, one.out.setpoint.velocity_world_mps.head<2>().norm());
      if (one.out.is_sinking) {
        EXPECT_GT((one.position_m - walker_m).head<2>().norm(), one.limits.landing_clearance_m);
        EXPECT_LT((one.position_m.head<2>() - one.setpoint_m()).norm(), 0.01);
      } else {
        EXPECT_NEAR(one.out.setpoint.position_world_m.z(), 1.5, 1e-6);
      }
    }
    EXPECT_LT(one.position_m.z(), 0.03);
    EXPECT_NEAR(fastest_mps, 0.6, 0.01);
    one.finish_landing();
  }
}

// The vehicle has drifted from its hover position. A body is below the vehicle or below the hover
// position. The vehicle lands at a spot that is free of both.
TEST(Landing, AvoidsBodiesBelowVehicleAndHover) {
  for (const double at_m : {-0.5, 0.85}) {  // closer than 0.7 m to only one of the two
    OneVehicle one;
    const Eigen::Vector3d walker_m(at_m, 0.0, 0.2);
    one.position_m = {0.0, 0.0, 1.5};
    one.run(0.4);
    one.tracks_setpoint = false;
    one.drift_mps = Eigen::Vector3d(0.3, 0.0, 0.0);
    one.run(0.8);  // s; short enough that the return within one tick passes the pose gate
    one.drift_mps = Eigen::Vector3d::Zero();
    one.others = {one.body("W1", walker_m)};
    one.run(0.1);
    one.others = {one.body("W1", walker_m)};
    one.send_command(OperatorAction::kLand);
    one.tick();
    EXPECT_EQ(one.state(), FlightState::kLand);
    EXPECT_FALSE(one.out.is_sinking) << at_m;
    one.drift_mps.reset();
    one.tracks_setpoint = true;
    for (int i = 0; i < 400 && one.position_m.z() > 0.1; ++i) {
      one.others = {one.body("W1", walker_m)};
      one.tick();
      if (one.out.is_sinking) {
        EXPECT_GT((one.position_m - walker_m).head<2>().norm(), one.limits.landing_clearance_m);
      }
    }
    EXPECT_LT(one.position_m.z(), 0.11);
  }
}

// A vehicle that does not reach its landing spot descends 6 s after the command to move there. A
// vehicle within 0.25 m of the spot descends at the expected arrival time.
TEST(Landing, DescendsAfterTheTimeLimitIfTheSpotIsNotReached) {
  OneVehicle one;
  const Eigen::Vector3d walker_m(-0.1, 0.0, 0.3);
  for (const double off_m : {0.24, 0.26, 0.24, 0.26}) {
    one.others = {one.body("W1", walker_m)};
    one.begin_landing_at({0.0, 0.0, 1.5});
    double waited_s = OneVehicle::kTickS;
    double moved_s = 0.0;
    while (!one.out.is_sinking && waited_s < 12.0) {
      one.others = {one.body("W1", walker_m)};
      const Eigen::Vector2d away_m = one.setpoint_m() - walker_m.head<2>();
      one.setpoint_offset_m.head<2>() = std::min(off_m, 0.2 * waited_s) * away_m.normalized();
      one.tick();
      waited_s += OneVehicle::kTickS;
      moved_s = one.out.setpoint.velocity_world_mps.head<2>().norm() > 1e-9 ? waited_s : moved_s;
    }
    EXPECT_LT(moved_s, 3.0);
    EXPECT_NEAR(waited_s, off_m < 0.25 ? moved_s + 0.1 : 6.04, 0.06) << off_m;
    one.setpoint_offset_m.setZero();
    one.finish_landing();
  }
}

// The vehicle waits for a free landing spot for at most 20 s. The second flight does the same.
TEST(Landing, DescendsAfterTheTimeLimitWithoutAFreeSpot) {
  scenario::Scenario room = OneVehicle::room();
  room.world.bounds = {{-0.5, -0.5}, {0.5, 0.5}};
  OneVehicle one({0.0, 0.0, 1.5}, 0.0, room);
  for (int flight = 0; flight < 2; ++flight) {
    one.others = {one.body("W1", {0.1, 0.0, 0.2})};
    one.begin_landing_at({0.0, 0.0, 1.5});
    double waited_s = 0.0;
    while (!one.out.is_sinking && waited_s < 30.0) {
      one.others = {one.body("W1", {0.1, 0.0, 0.2})};
      one.tick();
      waited_s += OneVehicle::kTickS;
      if (!one.out.is_sinking) {
        EXPECT_NEAR(one.out.setpoint.position_world_m.z(), 1.5, 1e-6);
      }
    }
    EXPECT_NEAR(waited_s, 20.0, 0.05);
    one.run(1.0, [&] {
      EXPECT_TRUE(one.out.is_sinking);
      EXPECT_LT(one.out.setpoint.velocity_world_mps.z(), -0.3);
    });
    one.finish_landing();
  }
}

// A landing that begins close to the ground ignores bodies below. The second flight does the same.
TEST(Landing, IgnoresBodiesWhenItBeginsLow) {
  OneVehicle one;
  for (const double from_m : {0.33, 0.37, 0.33, 0.37}) {
    one.others = {one.body("W1", {0.6, 0.0, 0.05})};
    one.begin_landing_at({0.0, 0.0, from_m});
    EXPECT_EQ(one.out.is_sinking, from_m < 0.35) << from_m;
    one.finish_landing();
  }
}

// A descent stops at its current height when a body moves in below, and continues when the body has
// left. Below 0.15 m it does not stop.
TEST(Landing, PausesForABodyUntilItIsLow) {
  for (const double at_m : {0.8, 0.2, 0.1}) {
    scenario::Scenario room = OneVehicle::room();
    room.world.bounds = {{-0.5, -0.5}, {0.5, 0.5}};
    OneVehicle one({0.0, 0.0, 1.5}, 0.0, room);
    one.begin_landing_at({0.0, 0.0, 1.5});
    for (int i = 0; i < 400 && one.position_m.z() > at_m; ++i) {
      one.tick();
    }
    const double here_m = one.position_m.z();
    one.tracks_setpoint = false;
    one.drift_mps = Eigen::Vector3d::Zero();
    one.run(1.0, [&] { one.others = {one.body("W1", {0.1, 0.0, here_m - 0.1})}; });
    EXPECT_EQ(one.out.is_sinking, at_m < 0.15) << at_m;
    if (at_m > 0.15) {
      EXPECT_NEAR(one.out.setpoint.position_world_m.z(), here_m, 1e-6);
      EXPECT_NEAR(one.in().tracking_error_m, 0.0, 1e-3);
      one.run(3.0, [&] { one.others = {one.body("W1", {1.2, 0.0, here_m - 0.1})}; });
      EXPECT_TRUE(one.out.is_sinking) << at_m;
    }
  }
}

// When the path to the spot aside becomes blocked, the vehicle stops and searches for a new spot.
TEST(Landing, StopsWhenThePathAsideIsBlocked) {
  OneVehicle one;
  const Eigen::Vector3d below_m(-0.1, 0.0, 0.3);
  one.others = {one.body("W1", below_m)};
  one.begin_landing_at({0.0, 0.0, 1.5});
  one.run(0.5, [&] { one.others = {one.body("W1", below_m)}; });
  const Eigen::Vector2d offset_m = one.out.setpoint.velocity_world_mps.head<2>();
  ASSERT_GT(offset_m.norm(), 0.3);
  const Eigen::Vector3d ahead_m =
      one.position_m + 0.62 * Eigen::Vector3d(offset_m.x(), offset_m.y(), 0.0).normalized();
  bool has_stopped = false;
  one.run(1.0, [&] {
    one.others = {one.body("W1", below_m), one.body("W2", ahead_m)};
    has_stopped = has_stopped || one.out.setpoint.velocity_world_mps.head<2>().norm() < 1e-9;
  });
  EXPECT_TRUE(has_stopped);
  EXPECT_GT((one.position_m - ahead_m).norm(), one.limits.separation_land_m);
  EXPECT_FALSE(one.out.is_sinking &&
               (one.position_m - ahead_m).head<2>().norm() < one.limits.landing_clearance_m);
}

// A free path to the spot aside is flown to its end without a stop.
TEST(Landing, MovesAsideOnAFreePathWithoutStopping) {
  OneVehicle one;
  const Eigen::Vector3d below_m(-0.1, 0.0, 0.3);
  one.others = {one.body("W1", below_m)};
  one.begin_landing_at({0.0, 0.0, 1.5});
  bool has_moved = false;
  bool has_stopped = false;
  while (!one.out.is_sinking && one.ticks < 500) {
    one.others = {one.body("W1", below_m)};
    one.tick();
    const double mps = one.out.setpoint.velocity_world_mps.head<2>().norm();
    has_stopped = has_stopped || (has_moved && mps < 1e-9);
    EXPECT_TRUE(!has_stopped || mps < 1e-9) << "moves only once";
    has_moved = has_moved || mps > 0.3;
  }
  EXPECT_TRUE(has_moved);
  EXPECT_LT(one.ticks, 200);
}

// Pushing a vehicle down while its landing waits must not count as the start of the descent.
TEST(Landing, PushDownDoesNotStartTheDescent) {
  OneVehicle one;
  const auto walker = [&] { one.others = {one.body("W1", {0.65, 0.0, 0.1})}; };
  walker();
  one.begin_landing_at({0.0, 0.0, 0.4});
  one.tracks_setpoint = false;
  one.drift_mps = Eigen::Vector3d(0.0, 0.0, -0.5);
  walker();
  one.run(0.54, walker);
  one.drift_mps = Eigen::Vector3d::Zero();
  EXPECT_LT(one.position_m.z(), 0.14);
  one.run(0.1, walker);
  EXPECT_FALSE(one.out.is_sinking);
}

// The vehicle has descended 0.2 m at its spot. A body below the vehicle, or only below the spot,
// stops the descent. The vehicle then moves from its position to a free spot.
TEST(Landing, StopsForBodiesBelowVehicleOrSpot) {
  for (const double at_m : {-0.55, 0.8}) {
    OneVehicle one;
    for (int i = 1; i <= 20; ++i) {
      one.setpoint_offset_m.x() = 0.01 * i;
      one.tick();
    }
    one.begin_landing_at({0.2, 0.0, 1.5});
    one.run(0.2);
    EXPECT_TRUE(one.out.is_sinking);
    EXPECT_NEAR((one.position_m.head<2>() - one.setpoint_m()).norm(), 0.2, 1e-6);
    const Eigen::Vector2d before_m = one.setpoint_m();
    const Eigen::Vector3d walker_m(before_m.x() + at_m, before_m.y(), 0.2);
    one.others = {one.body("W1", walker_m)};
    one.tick();
    EXPECT_FALSE(one.out.is_sinking) << at_m;
    drivers::OtherBody walker;
    walker.position_world_m = walker_m;
    const Eigen::Vector3d from_m =
        at_m > 0.0 ? one.position_m
                   : Eigen::Vector3d(before_m.x(), before_m.y(), one.position_m.z());
    const Eigen::Vector3d spot_m = drivers::landing_spot(from_m, {&walker, 1}, one.limits);
    one.tracks_setpoint = false;
    one.drift_mps = Eigen::Vector3d::Zero();
    one.run(3.0, [&] { one.others = {one.body("W1", walker_m)}; });
    EXPECT_LT((one.setpoint_m() - spot_m.head<2>()).norm(), 1e-3) << at_m;
  }
}

// After the descent has become final, the set-point stays above the spot and does not follow the
// vehicle.
TEST(Landing, KeepsItsSpotDuringTheFinalDescent) {
  OneVehicle one;
  for (int i = 1; i <= 20; ++i) {
    one.setpoint_offset_m.x() = 0.01 * i;
    one.tick();
  }
  one.begin_landing_at({0.2, 0.0, 0.8});
  const Eigen::Vector2d place_m = one.setpoint_m();
  while (one.position_m.z() > 0.03 && one.ticks < 1000) {
    one.tick();
    EXPECT_LT((one.setpoint_m() - place_m).norm(), 1e-6);
  }
  EXPECT_LT(one.position_m.z(), 0.04);
}

// While the vehicle moved aside, the estimator failed and the vehicle sank so low that the landing
// is final. The vehicle stops within its braking distance and does not continue to move aside.
TEST(Landing, DoesNotMoveAsideOnceLow) {
  OneVehicle one;
  const auto walker = [&] { one.others = {one.body("W1", {-0.62, 0.0, 0.1})}; };
  walker();
  one.begin_landing_at({0.0, 0.0, 0.5});
  one.run(0.5, walker);
  ASSERT_GT(one.out.setpoint.velocity_world_mps.head<2>().norm(), 0.05);
  one.report.estimator_good = false;
  one.drift_mps = Eigen::Vector3d(0.1, 0.0, -0.9);
  one.run(0.42, walker);
  EXPECT_LT(one.position_m.z(), 0.15);
  one.report.estimator_good = true;
  one.drift_mps = Eigen::Vector3d(0.3, 0.0, 0.0);
  const Eigen::Vector2d here_m = one.position_m.head<2>();
  one.run(0.6, walker);
  EXPECT_EQ(one.state(), FlightState::kLand);
  EXPECT_EQ(one.out.setpoint.kind, FlightSetpoint::Kind::kTrack);
  EXPECT_LT(one.out.setpoint.velocity_world_mps.head<2>().norm(), 1e-9);
  EXPECT_LT((one.setpoint_m() - here_m).norm(), 0.05);
}

// The time limit of 6 s starts again with the command to move to each spot.
TEST(Landing, CountsTheTimeToEachSpotSeparately) {
  OneVehicle one;
  one.begin_landing_at({0.0, 0.0, 1.5});
  one.hold_at_height(1.5);
  one.run(2.0);
  EXPECT_TRUE(one.out.is_sinking);
  const Eigen::Vector3d walker_m(-0.1, 0.0, 0.3);
  double waited_s = 0.0;
  do {
    one.others = {one.body("W1", walker_m)};
    const Eigen::Vector2d away_m = one.setpoint_m() - walker_m.head<2>();
    one.setpoint_offset_m.head<2>() = std::min(0.26, 0.2 * waited_s) * away_m.normalized();
    one.tick();
    waited_s += OneVehicle::kTickS;
  } while (!one.out.is_sinking && waited_s < 10.0);
  EXPECT_NEAR(waited_s, 6.04, 0.06);
}

// A vehicle that is found landing at the fence is moved inside. The second flight does the same.
TEST(Landing, MovesInsideTheFenceWhenFoundOutside) {
  OneVehicle one;
  one.report.is_in_our_mode = false;
  one.report.is_landing_itself = true;
  for (int flight = 0; flight < 2; ++flight) {
    one.position_m = {4.7, 1.0, 1.5};
    one.report.armed = true;
    one.run(2.0);
    EXPECT_EQ(one.state(), FlightState::kLand);
    EXPECT_NEAR(one.setpoint_m().x(), 5.0 - 0.25 - 0.1, 1e-6) << flight;
    one.finish_landing();
  }
}

}  // namespace
}  // namespace vantage::test
