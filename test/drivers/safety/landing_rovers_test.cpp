#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "drivers/safety/surroundings.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/support/random.hpp"

// Tests of landing spots and of approaching bodies.

namespace vantage::drivers {
namespace {

SafetyLimits wide_limits() {
  SafetyLimits limits = limits_for(test::FlightBench::scenario(), "Q1");
  limits.fence.bounds = {{-10.0, -10.0}, {10.0, 10.0}};
  limits.fence.obstacles.clear();
  return limits;
}

// A body below has been unseen for a long time. The landing spot is on the nearest ring with enough
// distance, up to 1.5 m away.
TEST(LandingSpot, IsOnTheNearestFreeRing) {
  SafetyLimits limits = wide_limits();
  const Eigen::Vector3d hover_m(0.5, -0.5, 1.0);
  OtherBody below;
  below.position_world_m = {hover_m.x(), hover_m.y(), 0.0};
  below.age_s = 100.0;
  EXPECT_EQ(landing_spot(hover_m, {}, limits), hover_m);
  for (const double clearance_m : {0.1, 0.3, limits.landing_clearance_m}) {
    limits.landing_clearance_m = clearance_m;
    for (const double grown_m : {0.0, 0.2, 0.45, 0.7, 0.75}) {
      limits.other_pose_growth_max_m = grown_m;
      const double needed_m = clearance_m + grown_m + 0.1;
      const double ring_m = 0.25 * std::ceil(needed_m / 0.25);
      const Eigen::Vector3d spot_m = landing_spot(hover_m, {&below, 1}, limits);
      EXPECT_EQ(spot_m.z(), hover_m.z());
      EXPECT_NEAR((spot_m - hover_m).norm(), ring_m <= 1.5 ? ring_m : 0.0, 1e-9) << needed_m;
    }
  }
}

// Stationary robots are ignored, because they may wait for their turn. Moving robots and all other
// bodies count.
TEST(PredictedDistance, IgnoresStationaryRobotsOnly) {
  const Eigen::Vector3d here_m(1.0, 2.0, 0.0);
  const double never_m = std::numeric_limits<double>::infinity();
  const auto near_m = [&](int robot, double vx_mps) {
    OtherBody body;
    body.position_world_m = {4.0, 2.0, 7.0};
    body.velocity_world_mps = {vx_mps, 0.0, 5.0};
    body.robot = robot;
    return predicted_distance_m(here_m, {&body, 1}, 2.0);
  };
  EXPECT_EQ(predicted_distance_m(here_m, {}, 2.0), never_m);
  EXPECT_EQ(near_m(1, 0.0), never_m);
  EXPECT_EQ(near_m(0, 0.09), never_m);
  EXPECT_DOUBLE_EQ(near_m(1, -0.11), 3.0 - 0.22);
  EXPECT_DOUBLE_EQ(near_m(0, 0.11), 3.0);
  EXPECT_DOUBLE_EQ(near_m(-1, 0.0), 3.0);
  EXPECT_DOUBLE_EQ(near_m(-1, -1.0), 1.0);
}

// The set-point starts at the vehicle's position and sinks at the configured speed, which is lower
// near the ground. A vehicle that tracks it well does not descend faster.
TEST(FlightGuard, DescendsAtTheStatedSpeeds) {
  test::FlightBench bench(3, false, 0.7);
  bench.fly_up(3.0);
  test::Vehicle& q3 = bench.vehicle("Q3");
  const SafetyLimits limits = limits_for(test::FlightBench::scenario(0.7), "Q3");
  ASSERT_GT(q3.position_m.z(), limits.low_height_m + 0.5);
  bench.send_command(models::OperatorAction::kLand, "Q3");
  bench.tick();
  const auto asked_m = [&] {  // current set-point without the lead
    const FlightSetpoint& out = q3.out.setpoint;
    return out.position_world_m.z() - limits.setpoint_lead_s * out.velocity_world_mps.z();
  };
  double last_m = asked_m();
  double fastest_mps = 0.0;
  double fastest_low_mps = 0.0;
  bench.run(10.0, [&] {
    if (q3.out.state == models::FlightState::kLand) {
      ASSERT_EQ(q3.out.setpoint.kind, FlightSetpoint::Kind::kTrack);
      double& fastest = last_m < limits.low_height_m ? fastest_low_mps : fastest_mps;
      fastest = std::max(fastest, (last_m - asked_m()) / test::FlightBench::kTickS);
      last_m = asked_m();
    }
  });
  EXPECT_NEAR(fastest_mps, limits.descent_mps, 1e-9);
  EXPECT_NEAR(fastest_low_mps, limits.low_descent_mps, 1e-9);
  EXPECT_EQ(q3.out.state, models::FlightState::kIdle);
}

// Three vehicles land simultaneously among five rovers that drive at up to 0.5 m/s with random
// turns. No vehicle is hit, and few landings take more than 8 s. (Preferring spots that no rover
// drives towards had little effect: 28 instead of 37 of 360 landings took over 8 s.)
TEST(FlightGuard, LandsAmongRoversWithRandomTurns) {
  constexpr double kRoverMps = 0.5;
  const models::Rectangle bounds = limits_for(test::FlightBench::scenario(), "Q1").fence.bounds;
  std::vector<double> took_s;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    test::FlightBench bench(seed, false, 0.5);
    test::Random random(seed);
    bench.fly_up(12.0 + random.uniform(0.0, 12.0));
    std::vector<Eigen::Vector3d> rovers_m;
    std::vector<double> headings_rad;
    for (int i = 0; i < 5; ++i) {
      rovers_m.emplace_back(random.uniform(bounds.min_m.x(), bounds.max_m.x()),
                            random.uniform(bounds.min_m.y(), bounds.max_m.y()), 0.0);
      headings_rad.push_back(random.uniform(-kPi, kPi));
    }
    bench.room().command = models::OperatorAction::kLand;
    const double start_s = bench.time_s();
    double least_m = 1e9;
    std::vector<double> down_s(bench.vehicles().size(), 30.0);
    bench.run(30.0, [&] {
      for (std::size_t i = 0; i < rovers_m.size(); ++i) {
        headings_rad[i] += random.normal() * std::sqrt(test::FlightBench::kTickS);  // 1σ: 1 rad/√s
        Eigen::Vector3d ahead_m = rovers_m[i] + kRoverMps * test::FlightBench::kTickS *
                                                    Eigen::Vector3d(std::cos(headings_rad[i]),
                                                                    std::sin(headings_rad[i]), 0.0);
        bool is_down_there = false;  // rovers do not drive into a landed vehicle
        for (const test::Vehicle& vehicle : bench.vehicles()) {
          is_down_there = is_down_there || (vehicle.position_m.z() < 0.5 &&
                                            (vehicle.position_m - ahead_m).norm() < 0.75);
        }
        if (!bounds.contains(ahead_m.head<2>()) || is_down_there) {
          headings_rad[i] += 0.5 * kPi;
          ahead_m = rovers_m[i];
        }
        rovers_m[i] = ahead_m;
      }
      bench.room().target_positions_m = rovers_m;
      for (std::size_t v = 0; v < down_s.size(); ++v) {
        const test::Vehicle& vehicle = bench.vehicles()[v];
        const bool is_down = vehicle.position_m.z() < 0.05;
        down_s[v] = is_down ? std::min(down_s[v], bench.time_s() - start_s) : down_s[v];
        for (const Eigen::Vector3d& rover_m : rovers_m) {
          least_m = std::min(least_m, is_down ? 1e9 : (vehicle.position_m - rover_m).norm());
        }
      }
    });
    EXPECT_TRUE(bench.violations().empty()) << seed << ": " << bench.violations().front();
    EXPECT_GT(least_m, 0.5) << seed;
    took_s.insert(took_s.end(), down_s.begin(), down_s.end());
  }
  const auto slower_than = [&](double limit_s) {
    return std::count_if(took_s.begin(), took_s.end(), [&](double s) { return s > limit_s; });
  };
  EXPECT_LE(slower_than(8.0), 12);  // of 60 landings; a longer run had 37 of 360
  EXPECT_EQ(slower_than(25.0), 0);
}

}  // namespace
}  // namespace vantage::drivers
