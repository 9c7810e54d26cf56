// Tests of a vehicle that moves against its commands, also upwards. Its poses must be accepted; the
// vehicle must hold, then land, then stop its motors.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::test {
namespace {

using models::FlightState;

struct Seen {
  double held_s = -1.0, landed_s = -1.0, killed_s = -1.0;
  Eigen::Vector3d killed_at_m = Eigen::Vector3d::Zero();
  double oldest_pose_s = 0.0;
};

/// Commands Q1 to hover in the middle of the room while a fault carries it away at `mps`, m/s.
Seen carry_away(const Eigen::Vector3d& mps, double seconds) {
  FlightBench bench(3);
  bench.fly_up(3.0);  // hovers above its start
  Vehicle& q1 = bench.vehicle("Q1");
  Seen seen;
  const double start_s = bench.time_s();
  bench.run(seconds, [&] {
    // The additional 1.3 m/s compensate the speed that its controller commands in the opposite
    // direction.
    q1.knobs.runaway_mps = mps + 1.3 * mps.normalized();
    const double since_s = bench.time_s() - start_s;
    const auto note = [&](double& at_s, FlightState state) {
      at_s = at_s < 0.0 && q1.out.state == state ? since_s : at_s;
    };
    note(seen.held_s, FlightState::kHold);
    note(seen.landed_s, FlightState::kLand);
    if (seen.killed_s < 0.0 && q1.out.state == FlightState::kKilled) {
      seen.killed_s = since_s;
      seen.killed_at_m = q1.position_m;
    }
    if (seen.killed_s < 0.0) {
      seen.oldest_pose_s = std::max(seen.oldest_pose_s, q1.guard->inputs().pose_age_s);
    }
  });
  return seen;
}

// Regression: a vehicle in `hold` climbed to 12 m, because its poses were refused above one metre
// over the ceiling.
TEST(Runaway, UpwardRunawayLandsAndStopsItsMotorsAboveTheCeiling) {
  const Seen seen = carry_away({0.0, 0.0, 0.7}, 8.0);
  ASSERT_GE(seen.landed_s, 0.0);
  EXPECT_LT(seen.landed_s, 2.5) << "1 m off its height";
  ASSERT_GE(seen.killed_s, 0.0);
  EXPECT_GT(seen.killed_at_m.z(), 3.9);
  EXPECT_LT(seen.killed_at_m.z(), 4.2) << "the ceiling is at 3 m";
  EXPECT_LT(seen.oldest_pose_s, 0.05) << "a body that moves out of the room stays tracked";
}

TEST(Runaway, SidewaysRunawayLandsInEveryDirection) {
  for (const Eigen::Vector3d& way :
       {Eigen::Vector3d(0.7, 0.0, 0.0), Eigen::Vector3d(-0.7, 0.0, 0.0),
        Eigen::Vector3d(0.0, 0.7, 0.0), Eigen::Vector3d(0.0, -0.7, 0.0)}) {
    const Seen seen = carry_away(way, 12.0);
    SCOPED_TRACE(way.transpose());
    ASSERT_GE(seen.landed_s, 0.0);
    EXPECT_LT(seen.landed_s, 2.5);
    if (seen.killed_s >= 0.0) {
      const Eigen::Vector3d out_m = seen.killed_at_m.cwiseAbs() - Eigen::Vector3d(4.0, 2.2, 0.0);
      EXPECT_NEAR(std::max(out_m.x(), out_m.y()), 1.0, 0.15);
    }
    EXPECT_LT(seen.oldest_pose_s, 0.05);
  }
}

// A pose outside the room that does not continue the measured motion is refused, also in the air.
TEST(Runaway, JumpOutOfTheRoomIsIgnored) {
  FlightBench bench(3);
  bench.fly_up(3.0);
  Vehicle& q1 = bench.vehicle("Q1");
  bench.run(0.2, [&] { q1.knobs.offset_m = 7.0; });
  EXPECT_GT(q1.guard->inputs().pose_age_s, 0.15);
  EXPECT_LT(q1.guard->world_from_body().translation_m.x(), 0.0);
}

/// Lands Q1 and takes off again. The second flight starts without height error, flight time or
/// battery age from the first.
void fly_again(FlightBench& bench, Vehicle& q1) {
  bench.send_command(models::OperatorAction::kLand);
  bench.run(12.0);
  ASSERT_EQ(q1.out.state, FlightState::kIdle);
  EXPECT_EQ(q1.guard->inputs().flight_s, 0.0);
  EXPECT_EQ(q1.guard->inputs().tracking_error_m, 0.0);
  bench.send_command(models::OperatorAction::kArm, "Q1");
  bench.run(1.5);
  bench.send_command(models::OperatorAction::kTakeOff, "Q1");
  bench.tick();
  double left_s = bench.time_s();
  while (q1.out.state != FlightState::kHold && bench.time_s() < 40.0) {
    left_s = bench.time_s();
    bench.tick();
  }
  bench.run(10.0);
  ASSERT_EQ(q1.out.state, FlightState::kHold);
  EXPECT_NEAR(q1.position_m.z(), 1.0, 0.05);
  EXPECT_NEAR(q1.guard->inputs().flight_s, bench.time_s() - left_s, 0.03);
  EXPECT_LE(q1.guard->inputs().battery_unchanged_s, 0.6);
  EXPECT_FALSE(FlightBench::has_reason(q1, "tracking", bench.now()));
}

// The tracking error includes the height error, also in the second flight.
TEST(Runaway, HeightErrorCountsAsTrackingError) {
  for (const bool is_second : {false, true}) {
    for (const double push_mps : {1.0, -1.0}) {
      FlightBench bench(3);
      Vehicle& q1 = bench.vehicle("Q1");
      bench.fly_up(3.0);
      if (is_second) {
        ASSERT_NO_FATAL_FAILURE(fly_again(bench, q1));
      }
      bench.run(3.0, [&] { q1.knobs.runaway_mps = {0.0, 0.0, push_mps}; });
      const double off_m = q1.position_m.z() - 1.0;
      EXPECT_GT(std::abs(off_m), 0.4);
      EXPECT_NEAR(q1.guard->inputs().tracking_error_m, std::abs(off_m), 0.03);
      EXPECT_TRUE(FlightBench::has_reason(q1, "tracking", bench.now()));
    }
  }
}

// A climb may take 5 s plus twice its nominal time. A vehicle that is still below its goal then has
// a tracking error.
TEST(Runaway, DescentInAClimbIsATrackingErrorAfterTheTimeLimit) {
  FlightBench bench(3);
  Vehicle& q1 = bench.vehicle("Q1");
  bool has_lifted = false;
  double begin_s = 0.0;
  double said_s = 9.0;
  while (bench.time_s() < 5.0 && said_s > 5.0) {
    if (begin_s < 0.0) {
      q1.knobs.runaway_mps = {0.0, 0.0, -1.0};  // keeps it half a metre below its set-point
    }
    bench.fly_up(bench.time_s() + 0.5 * FlightBench::kTickS);
    const bool lifts = FlightBench::has_reason(q1, "first lift", bench.now());
    begin_s = has_lifted && !lifts && begin_s == 0.0 ? bench.time_s() : begin_s;
    has_lifted = has_lifted || lifts;
    said_s = FlightBench::has_reason(q1, "tracking", bench.now()) ? bench.time_s() : said_s;
  }
  ASSERT_LT(begin_s, -5.0);
  const drivers::SafetyLimits limits = drivers::limits_for(FlightBench::scenario(), "Q1");
  EXPECT_NEAR(said_s - begin_s, 5.0 + 2.0 * 1.0 / limits.climb_mps, 0.3);
}

// A vehicle faster than its maximum speed changes to HOLD.
TEST(Runaway, VehicleFasterThanItsLimitHolds) {
  for (const double way : {1.0, -1.0}) {
    FlightBench bench(3);
    bench.fly_up(6.4);
    Vehicle& q1 = bench.vehicle("Q1");
    bool is_too_fast = false;
    bench.run(0.6, [&] {
      q1.knobs.runaway_mps = {way * (q1.velocity_mps.x() > 0.0 ? 1.2 : -1.2), 0.0, 0.0};
      is_too_fast = is_too_fast || FlightBench::has_reason(q1, "too fast", bench.now());
    });
    EXPECT_EQ(is_too_fast, way > 0.0) << "slower against its direction of motion";
  }
}

// The vehicle is carried up during a landing. The set-point follows at the climb speed at most.
TEST(Runaway, SetpointKeepsSpeedLimitsWhenALandingIsPushedUp) {
  FlightBench bench(3);
  bench.fly_up(3.0);
  bench.send_command(models::OperatorAction::kLand);
  bench.tick();
  bench.run(1.0);
  Vehicle& q1 = bench.vehicle("Q1");
  const drivers::SafetyLimits limits = drivers::limits_for(FlightBench::scenario(), "Q1");
  double steepest_mps = 0.0;
  bench.run(3.0, [&] {
    q1.knobs.runaway_mps = {0.0, 0.0, 2.3};
    if (q1.out.setpoint.kind == drivers::FlightSetpoint::Kind::kTrack) {
      const double asked_mps = q1.out.setpoint.velocity_world_mps.z();
      EXPECT_GE(asked_mps, -limits.descent_mps - 1e-9);
      EXPECT_LE(asked_mps, limits.climb_mps + 1e-9);
      steepest_mps = std::max(steepest_mps, asked_mps);
    }
  });
  EXPECT_NEAR(steepest_mps, limits.climb_mps, 1e-9);
}

}  // namespace
}  // namespace vantage::test
