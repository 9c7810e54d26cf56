// Tests that the measured motion of the body decides whether the vehicle is flying: when a driver
// starts in the air, and when the autopilot reports disarmed motors in flight.

#include <cmath>

#include <gtest/gtest.h>

#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::test {
namespace {

using models::FlightState;
using models::OperatorAction;

class FlyingAlready : public testing::Test {
 protected:
  FlyingAlready() : q1(bench.vehicle("Q1")) {}
  bool has(const std::string& reason) { return FlightBench::has_reason(q1, reason, bench.now()); }
  FlightBench bench{9};
  Vehicle& q1;
};

// Regression: a new driver went to `idle` in the air and landed the vehicle.
TEST_F(FlyingAlready, HoldsAfterARestartUntilFollow) {
  bench.fly_up(6.4);
  bench.run(0.5, [&] { q1.knobs.is_stalled = true; });
  bench.restart_driver(q1);
  bench.run(1.0);
  EXPECT_EQ(q1.out.state, FlightState::kHold);
  EXPECT_TRUE(has("found flying"));
  const Eigen::Vector3d place_m = q1.position_m;
  bench.run(6.0);
  EXPECT_EQ(q1.out.state, FlightState::kHold) << "plans arrive, but `follow` was not sent";
  EXPECT_LT((q1.position_m - place_m).norm(), 0.1);
  EXPECT_NEAR(q1.position_m.z(), 1.0, 0.1);
  bench.send_command(OperatorAction::kFollow);
  bench.run(4.0);
  EXPECT_EQ(q1.out.state, FlightState::kFollow);
  EXPECT_TRUE(bench.violations().empty()) << bench.violations().front();
}

TEST_F(FlyingAlready, LandsOnCommandAfterARestart) {
  bench.fly_up(6.4);
  bench.restart_driver(q1);
  bench.run(1.0);
  bench.send_command(OperatorAction::kLand);
  bench.run(10.0);
  EXPECT_EQ(q1.out.state, FlightState::kIdle);
  EXPECT_FALSE(q1.is_armed);
}

TEST_F(FlyingAlready, LandsWithoutAnOperatorAfterARestart) {
  bench.fly_up(6.4);
  bench.restart_driver(q1);
  double held_s = 0.0;
  bench.run(12.0, [&] {
    bench.room().operator_silent = true;
    held_s += q1.out.state == FlightState::kHold ? FlightBench::kTickS : 0.0;
  });
  EXPECT_GT(held_s, 1.0);
  EXPECT_EQ(q1.out.state, FlightState::kIdle);
  EXPECT_LT(q1.position_m.z(), 0.01);
}

TEST_F(FlyingAlready, LandsWithoutAPoseAfterARestart) {
  bench.fly_up(6.4);
  bench.restart_driver(q1);
  bench.run(8.0, [&] { q1.knobs.body = {BodyFault::kAbsent}; });
  EXPECT_NE(q1.out.state, FlightState::kHold);
  EXPECT_LT(q1.position_m.z(), 0.1);
}

// Regression: one disarmed report in flight made the guard idle and the driver land.
TEST_F(FlyingAlready, IgnoresDisarmedReportsInTheAir) {
  for (const double lasts_s : {0.02, 1.0, 6.0}) {
    FlightBench room(9);
    room.fly_up(6.4);
    Vehicle& vehicle = room.vehicle("Q1");
    room.run(lasts_s, [&] {
      vehicle.knobs.reports_disarmed = true;
      EXPECT_NE(vehicle.out.state, FlightState::kIdle);
      EXPECT_TRUE(vehicle.is_armed);
    });
    room.run(2.0);
    EXPECT_EQ(vehicle.out.state, FlightState::kFollow) << lasts_s;
    EXPECT_TRUE(room.violations().empty());
  }
}

// Without mocap, three consecutive heartbeats (one per second) must report disarmed motors. Until
// then the landing continues.
TEST_F(FlyingAlready, StaysArmedWithoutMocapForTwoHeartbeats) {
  bench.fly_up(6.4);
  const auto hide = [&] { q1.knobs.body = {BodyFault::kOccluded}; };
  bench.run(0.6, hide);
  bench.run(1.7, [&] {
    hide();
    q1.knobs.reports_disarmed = true;
    EXPECT_EQ(q1.out.state, FlightState::kLand);
    EXPECT_TRUE(q1.is_armed);
  });
  bench.run(1.2, [&] {
    hide();
    q1.knobs.reports_disarmed = true;
  });
  EXPECT_NE(q1.out.state, FlightState::kLand);
  EXPECT_FALSE(q1.is_armed);
}

// The third consecutive heartbeat that reports disarmed motors is accepted in the tick that
// receives it.
TEST_F(FlyingAlready, IsDisarmedWithoutMocapAtTheThirdHeartbeat) {
  bench.fly_up(6.4);
  int beats = 0;
  for (int tick = 0; tick < 300; ++tick) {
    const auto ticks = std::lround(bench.time_s() / FlightBench::kTickS);
    if (beats == 2) {  // mocap shows the flight until the second heartbeat
      q1.knobs.body = {BodyFault::kOccluded};
    }
    q1.knobs.reports_disarmed = true;
    bench.tick();
    beats += (ticks % 100 + 100) % 100 == 50 ? 1 : 0;
    if (drivers::is_airborne(q1.out.state)) {
      EXPECT_LT(beats, 3);
      EXPECT_TRUE(q1.guard->inputs().autopilot_armed);
    } else {
      EXPECT_EQ(beats, 3);
      EXPECT_EQ(q1.out.state, FlightState::kIdle);
      return;
    }
  }
  ADD_FAILURE() << "the disarmed reports were never accepted";
}

// If the motors are really off the vehicle falls, and mocap shows the fall immediately.
TEST_F(FlyingAlready, IsDisarmedWhenItFalls) {
  bench.fly_up(6.4);
  bench.run(0.6, [&] { q1.knobs.motors_off = true; });
  EXPECT_EQ(q1.out.state, FlightState::kIdle);
}

TEST_F(FlyingAlready, IsIdleWhenDisarmedOnTheGround) {
  bench.fly_up(6.4);
  bench.send_command(OperatorAction::kLand);
  while (q1.is_armed) {
    ASSERT_LT(bench.time_s(), 30.0);
    bench.tick();
  }
  bench.run(0.1);
  EXPECT_EQ(q1.out.state, FlightState::kIdle);
}

// Only mocap measures the ground height. A vehicle on the ground is unseen while its estimate
// drifts; then it is seen again and its motors are armed without a command. It must not count as
// flying.
TEST_F(FlyingAlready, IgnoresADriftedEstimateOnTheGround) {
  bench.run(1.0);
  bench.run(2.0, [&] {
    q1.knobs.body = {BodyFault::kOccluded};
    q1.drift_m.z() = -1.0;
  });
  bench.run(1.0, [&] {
    q1.is_armed = true;
    EXPECT_EQ(q1.out.state, FlightState::kIdle);
  });
  EXPECT_TRUE(q1.guard->inputs().autopilot_armed);
  EXPECT_LT(q1.guard->inputs().pose_age_s, 0.02);
}

}  // namespace
}  // namespace vantage::test
