// Tests the inputs of the ladder that are computed from messages. On the ground they are compared
// with closed forms, in a first lift with the true state of the bench.

#include "drivers/safety/inputs.hpp"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::drivers {
namespace {

using models::FlightState;
using models::OperatorAction;
using test::FlightBench;
using test::Vehicle;

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr double kSeenS = 0.02;  ///< s after kStart; inputs are evaluated 10 ms later
constexpr double kNowS = 0.03;

Time at(double t_s) { return kStart + from_seconds(t_s); }

Quaternion turned(double yaw_rad, double roll_rad = 0.0, double pitch_rad = 0.0) {
  return Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX());
}

/// Q1 (start at (-2, -1.3), yaw 0) is on the ground; one pose and one report were received.
class Inputs : public testing::Test {
 protected:
  void see(const Eigen::Vector3d& place_m, const Quaternion& rotation, double t_s = kSeenS) {
    models::MocapFrame frame;
    frame.stamp = {at(t_s), 3, number};
    frame.arrival = at(t_s);
    frame.frame_number = number++;
    frame.bodies.push_back({"Q1", {place_m, rotation}, false});
    EXPECT_TRUE(guard->on_mocap(frame, at(t_s)));
  }
  void feel(const Eigen::Vector3d& place_m, const Quaternion& rotation, double t_s = kSeenS) {
    AutopilotReport report;
    report.estimator_good = report.has_position = report.has_attitude = true;
    report.position_world_m = place_m;
    report.world_from_body = rotation;
    guard->on_autopilot(report, at(t_s));
  }
  const SafetyInputs& look(double t_s = kNowS) {
    (void)guard->tick(at(t_s));
    return guard->inputs();
  }

  scenario::Scenario scenario = FlightBench::scenario();
  SafetyLimits limits = limits_for(scenario, "Q1");
  std::optional<FlightGuard> guard{std::in_place, scenario, "Q1", limits};
  std::int64_t number = 0;
};

// Position errors in all components and with either sign count equally.
TEST_F(Inputs, ComparePositions) {
  const Eigen::Vector3d here_m(-2.1, -1.2, 0.05);
  for (const Eigen::Vector3d& off_m :
       {Eigen::Vector3d(0.4, -1.2, 0.3), Eigen::Vector3d(-1.2, 0.3, 0.4),
        Eigen::Vector3d(0.3, 0.4, -1.2), Eigen::Vector3d(0.0, 0.0, 0.0)}) {
    see(here_m, turned(0.0));
    feel(here_m + off_m, turned(0.0));
    EXPECT_NEAR(look().estimate_error_m, off_m.norm() > 0.0 ? 1.3 : 0.0, 1e-9);
  }
}

// Yaw and attitude are compared at any yaw of the body, with either sign of the error, and across
// ±π.
TEST_F(Inputs, CompareYawAndAttitude) {
  const Eigen::Vector3d here_m(-2.0, -1.3, 0.0);
  for (const double yaw_rad : {0.0, 1.0, -2.0, 3.1, -3.1}) {
    for (const double off_rad : {0.3, -0.3, 1.2, -1.2}) {
      guard.emplace(scenario, "Q1", limits);
      see(here_m, turned(yaw_rad));
      feel(here_m, turned(wrap_to_pi(yaw_rad + off_rad)));
      EXPECT_NEAR(look().yaw_error_rad, std::abs(off_rad), 1e-9) << yaw_rad;
      EXPECT_NEAR(guard->inputs().attitude_error_rad, 0.0, 1e-6) << "both are level";
      EXPECT_NEAR(guard->inputs().start_turn_rad, std::abs(yaw_rad), 1e-9);
      for (const bool is_roll : {true, false}) {
        feel(here_m, turned(yaw_rad, is_roll ? off_rad : 0.0, is_roll ? 0.0 : off_rad));
        EXPECT_NEAR(look().attitude_error_rad, std::abs(off_rad), 1e-6);
        EXPECT_NEAR(guard->inputs().yaw_error_rad, 0.0, 1e-9);
        EXPECT_NEAR(guard->inputs().body_tilt_rad, 0.0, 1e-9);
      }
    }
  }
}

TEST_F(Inputs, MeasureTiltAndDistanceFromTheStart) {
  const Eigen::Vector3d start_m(-2.0, -1.3, 0.0);
  for (const double off_rad : {0.4, -0.4}) {
    guard.emplace(scenario, "Q1", limits);
    see(start_m + Eigen::Vector3d(0.3, -0.4, 1.0), turned(0.7, off_rad, 0.0));
    EXPECT_NEAR(look().body_tilt_rad, 0.4, 1e-9);
    EXPECT_NEAR(guard->inputs().start_off_m, 0.5, 1e-9) << "horizontal distance only";
    guard.emplace(scenario, "Q1", limits);
    see(start_m + Eigen::Vector3d(-0.4, 0.3, 0.0), turned(-0.7, 0.0, off_rad));
    EXPECT_NEAR(look().body_tilt_rad, 0.4, 1e-9);
    EXPECT_NEAR(guard->inputs().start_off_m, 0.5, 1e-9);
  }
}

// Old or missing values are not compared. A missing attitude counts as the worst case.
TEST_F(Inputs, AreComparedOnlyWhileBothAreFresh) {
  const Eigen::Vector3d here_m(-2.0, -1.3, 0.0);
  const Eigen::Vector3d there_m(-2.0, -1.3, 0.7);
  const auto errors_of = [&](double seen_s, double felt_s) {
    guard.emplace(scenario, "Q1", limits);
    see(here_m, turned(0.0), seen_s);
    feel(there_m, turned(0.5), felt_s);
    const SafetyInputs& in = look(10.0);
    EXPECT_EQ(in.estimate_error_m > 0.0, in.yaw_error_rad > 0.0);
    return in.estimate_error_m;
  };
  constexpr double kMomentS = 1e-3;
  const double seen_s = 10.0 - limits.pose_age_warn_s;
  const double felt_s = 10.0 - limits.telemetry_age_hold_s;
  EXPECT_NEAR(errors_of(seen_s + kMomentS, felt_s + kMomentS), 0.7, 1e-9);
  EXPECT_EQ(errors_of(seen_s - kMomentS, felt_s + kMomentS), 0.0);
  EXPECT_EQ(errors_of(seen_s + kMomentS, felt_s - kMomentS), 0.0);
  for (const bool says_place : {true, false}) {
    for (const bool is_good : {true, false}) {
      guard.emplace(scenario, "Q1", limits);
      see(here_m, turned(0.0));
      AutopilotReport report;
      report.estimator_good = is_good;
      report.has_position = says_place;
      report.position_world_m = there_m;
      guard->on_autopilot(report, at(kSeenS));
      const bool is_compared = says_place && is_good;
      EXPECT_NEAR(look().estimate_error_m, is_compared ? 0.7 : 0.0, 1e-9);
      EXPECT_EQ(guard->inputs().yaw_error_rad, is_compared ? kNever : 0.0);
      EXPECT_EQ(guard->inputs().attitude_error_rad, is_compared ? kNever : 0.0);
      EXPECT_EQ(guard->inputs().estimator_good, is_good);
    }
  }
}

// A quaternion with a small length error does not change the tilt, upright or upside down.
TEST_F(Inputs, ComputeFiniteTilts) {
  for (const double length : {0.995, 1.0, 1.005}) {
    for (const double roll_rad : {0.0, kPi}) {
      guard.emplace(scenario, "Q1", limits);
      Quaternion rotation = turned(0.4, roll_rad);
      rotation.coeffs() *= length;
      see({-2.0, -1.3, 0.0}, rotation);
      EXPECT_NEAR(look().body_tilt_rad, roll_rad, length == 1.0 ? 1e-6 : 0.25) << length;
    }
  }
}

TEST_F(Inputs, MeasureTheTimeSinceTheLastTick) {
  EXPECT_EQ(look(1.0).since_last_tick_s, 0.0);
  EXPECT_NEAR(look(1.25).since_last_tick_s, 0.25, 1e-9);
  EXPECT_NEAR(look(1.26).since_last_tick_s, 0.01, 1e-9);
  const auto stalls = [&] {
    std::int64_t count = -1;
    for (const models::NamedCount& each : guard->counters()) {
      count = each.name == "tick.stalls" ? each.count : count;
    }
    return count;
  };
  EXPECT_EQ(stalls(), 0) << "0.25 s is no stall";
  for (const std::int64_t time : {1, 2}) {
    (void)look(2.0 * static_cast<double>(time));
    EXPECT_EQ(stalls(), time);
  }
}

TEST_F(Inputs, ContainTheProcessorWait) {
  EXPECT_EQ(look(1.0).processor_wait_s, 0.0) << "nothing is reported in virtual time";
  guard->on_processor_wait(0.3);
  EXPECT_EQ(look(1.1).processor_wait_s, 0.3);
  EXPECT_EQ(look(9.0).processor_wait_s, 0.3) << "until the next report";
  guard->on_processor_wait(0.0);
  EXPECT_EQ(look(9.1).processor_wait_s, 0.0);
}

// While the vehicle must stay on the ground, its rise is measured from its ground position, which
// may be on a table.
TEST_F(Inputs, MeasureARiseWithoutAnOrder) {
  for (const double table_m : {0.0, 0.4}) {
    guard.emplace(scenario, "Q1", limits);
    number = 0;
    double risen_m = 0.0;
    GuardOutput out;
    for (int tick = 0; tick < 500; ++tick) {
      const double t_s = 0.01 * tick;
      risen_m = tick < 400 ? 0.0 : 0.02 + 0.002 * (tick / 20 % 2);
      const Eigen::Vector3d here_m(-2.0, -1.3, table_m + risen_m);
      see(here_m, turned(0.0), t_s);
      AutopilotReport report;
      report.armed = out.wants_armed;
      report.estimator_good = report.has_position = report.has_attitude = true;
      report.is_in_our_mode = true;
      report.position_world_m = here_m;
      guard->on_autopilot(report, at(t_s));
      guard->on_heartbeat(at(t_s));
      guard->on_battery(0.9, at(t_s));
      models::OperatorCommand command;
      command.stamp = {at(t_s), 7, tick};
      command.action = tick == 200 ? OperatorAction::kArm : OperatorAction::kHeartbeat;
      (void)guard->on_command(command, at(t_s));
      out = guard->tick(at(t_s));
      EXPECT_EQ(out.wants_armed, tick >= 200) << tick;
      EXPECT_NEAR(guard->inputs().unordered_rise_m, risen_m, 1e-9) << tick;
    }
    EXPECT_EQ(out.state, FlightState::kIdle);
  }
}

// Each input has its own age. The values that the autopilot reports about itself are unchanged.
TEST_F(Inputs, HaveSeparateAges) {
  const SafetyInputs& never = look(0.0);
  EXPECT_EQ(never.heartbeat_age_s, kNever);
  EXPECT_EQ(never.telemetry_age_s, kNever);
  EXPECT_EQ(never.battery_age_s, kNever);
  EXPECT_EQ(never.pose_age_s, kNever);
  for (const double begin_s : {1.0, 5.0}) {  // repeated later with the same guard
    guard->on_heartbeat(at(begin_s));
    AutopilotReport report;
    report.tilt_rad = 0.1 * begin_s;
    report.motor_failed = begin_s > 2.0;
    report.obeys = begin_s < 2.0;
    guard->on_autopilot(report, at(begin_s + 0.1));
    guard->on_battery(0.1 * begin_s, at(begin_s + 0.2));
    see({-2.0, -1.3, 0.0}, turned(0.0), begin_s + 0.3);
    const SafetyInputs& in = look(begin_s + 1.0);
    EXPECT_NEAR(in.heartbeat_age_s, 1.0, 1e-9);
    EXPECT_NEAR(in.telemetry_age_s, 0.9, 1e-9);
    EXPECT_NEAR(in.battery_age_s, 0.8, 1e-9);
    EXPECT_NEAR(in.pose_age_s, 0.7, 1e-9);
    EXPECT_EQ(in.tilt_rad, report.tilt_rad);
    EXPECT_EQ(in.motor_failed, report.motor_failed);
    EXPECT_EQ(in.autopilot_obeys, report.obeys);
    EXPECT_EQ(in.battery_share, 0.1 * begin_s);
    EXPECT_EQ(in.flight_s, 0.0) << "on the ground";
    EXPECT_EQ(in.battery_unchanged_s, 0.0);
    EXPECT_EQ(in.tracking_error_m, 0.0);
  }
}

// Values that are not finite, and shares outside 0 to 1, are ignored and counted.
TEST_F(Inputs, IgnoreNonFiniteReports) {
  const double nan = std::nan("");
  AutopilotReport good;
  good.has_position = good.has_attitude = true;
  good.tilt_rad = 0.2;
  guard->on_autopilot(good, at(0.0));
  guard->on_battery(0.6, at(0.0));
  std::vector<AutopilotReport> bad(5, good);
  bad[0].tilt_rad = nan;
  bad[1].position_world_m.z() = nan;
  bad[2].velocity_world_mps.y() = nan;
  bad[3].world_from_body.coeffs()[2] = nan;
  bad[4].yaw_rate_radps = nan;
  std::int64_t refused = 0;
  const auto expect_refused = [&] {
    EXPECT_NEAR(look(1.0).telemetry_age_s, 1.0, 1e-9) << refused;
    EXPECT_NEAR(guard->inputs().battery_age_s, 1.0, 1e-9) << refused;
    EXPECT_EQ(guard->inputs().tilt_rad, 0.2);
    EXPECT_EQ(guard->inputs().battery_share, 0.6);
    for (const models::NamedCount& each : guard->counters()) {
      EXPECT_EQ(each.count, each.name == "autopilot.refused" ? refused : 0) << each.name;
    }
  };
  for (const AutopilotReport& report : bad) {
    guard->on_autopilot(report, at(0.5));
    ++refused;
    expect_refused();
  }
  for (const double share : {-1e-9, 1.0 + 1e-9, nan}) {
    guard->on_battery(share, at(0.5));
    ++refused;
    expect_refused();
  }
  // Fields that the report does not declare as present are not checked. Both 0 and 1 are valid
  // shares.
  AutopilotReport little;
  little.position_world_m.x() = little.velocity_world_mps.x() = little.yaw_rate_radps = nan;
  little.world_from_body.coeffs()[0] = nan;
  guard->on_autopilot(little, at(1.5));
  for (const double share : {0.0, 1.0}) {
    guard->on_battery(share, at(1.5));
    EXPECT_NEAR(look(2.0).telemetry_age_s, 0.5, 1e-9);
    EXPECT_NEAR(guard->inputs().battery_age_s, 0.5, 1e-9);
    EXPECT_EQ(guard->inputs().battery_share, share);
  }
}

// In a first lift, the climb and turn rates of body and autopilot are compared: with either sign
// and on both sides of the limit.
TEST(FirstLiftInputs, CompareClimbAndTurnRates) {
  struct Lie {
    double climb_mps, turn_radps;
    bool is_found;
  };
  for (const Lie& lie :
       {Lie{0.25, 0.0, false}, Lie{-0.25, 0.0, false}, Lie{0.45, 0.0, true}, Lie{-0.45, 0.0, true},
        Lie{0.0, 0.7, false}, Lie{0.0, -0.7, false}, Lie{0.0, 0.9, true}, Lie{0.0, -0.9, true}}) {
    FlightBench bench(3);
    Vehicle& q1 = bench.vehicle("Q1");
    while (q1.position_m.z() < 0.1 && bench.time_s() < 0.0) {  // still climbing as commanded
      bench.fly_up(bench.time_s() + FlightBench::kTickS);
    }
    ASSERT_TRUE(FlightBench::has_reason(q1, "first lift", bench.now()));
    EXPECT_LT(q1.guard->inputs().lift_climb_error_mps, 0.1);
    EXPECT_EQ(q1.guard->inputs().lift_turn_error_radps, 0.0);
    double climb_error_mps = 0.0;
    double turn_error_radps = 0.0;
    for (int tick = 0; tick < 20 && q1.out.state == FlightState::kHold; ++tick) {
      AutopilotReport report;
      report.armed = report.estimator_good = report.is_in_our_mode = true;
      report.has_position = report.has_attitude = true;
      report.position_world_m = q1.position_m;
      report.velocity_world_mps = q1.velocity_mps + Eigen::Vector3d(0.0, 0.0, lie.climb_mps);
      report.world_from_body = turned(q1.yaw_rad);
      report.yaw_rate_radps = q1.turn_radps + lie.turn_radps;
      q1.knobs.telemetry_cut = true;  // the test sends reports instead of the bench
      q1.guard->on_autopilot(report, bench.now());
      bench.tick();
      if (q1.out.state == FlightState::kHold && tick < 5) {
        climb_error_mps = q1.guard->inputs().lift_climb_error_mps;
        turn_error_radps = q1.guard->inputs().lift_turn_error_radps;
      }
    }
    EXPECT_NEAR(climb_error_mps, std::abs(lie.climb_mps), 0.09);
    EXPECT_NEAR(turn_error_radps, std::abs(lie.turn_radps), 1e-9);
    EXPECT_EQ(q1.out.state, lie.is_found ? FlightState::kKilled : FlightState::kHold);
    EXPECT_EQ(FlightBench::has_reason(q1, "lift disagrees", bench.now()), lie.is_found);
  }
}

// The age of the battery value counts from its last change, or from the take-off.
TEST(FlightInputs, MeasureTheAgeOfTheBatteryValue) {
  FlightBench bench(3);
  Vehicle& q1 = bench.vehicle("Q1");
  bench.fly_up(3.0);
  bench.run(0.6, [&] { q1.knobs.battery_frozen = true; });
  const double unchanged_s = q1.guard->inputs().battery_unchanged_s;
  EXPECT_GE(unchanged_s, 0.05);
  bench.run(3.0, [&] { q1.knobs.battery_frozen = true; });
  EXPECT_NEAR(q1.guard->inputs().battery_unchanged_s, unchanged_s + 3.0, 1e-6);
  FlightBench frozen(3);
  Vehicle& other = frozen.vehicle("Q1");
  while (frozen.time_s() < 3.0) {
    other.knobs.battery_frozen = true;
    frozen.fly_up(frozen.time_s() + 0.5 * FlightBench::kTickS);
  }
  EXPECT_GT(other.guard->inputs().flight_s, 5.0);
  EXPECT_EQ(other.guard->inputs().battery_unchanged_s, other.guard->inputs().flight_s);
}

}  // namespace
}  // namespace vantage::drivers
