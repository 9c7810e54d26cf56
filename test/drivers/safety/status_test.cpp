// Compares the status and output of the guard during a complete flight with each other and with the
// true state of the bench.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "drivers/safety/conditions.hpp"
#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::test {
namespace {

using drivers::FlightSetpoint;
using models::FlightState;
using models::OperatorAction;

constexpr double kSpeedMaxMps = 1.0;

/// Expects that the set-point `soon`, extrapolated back by the lead time t, agrees with the current
/// one in the status. The tolerance is a t² / 2 with an acceleration a of 4 m/s².
void expect_asked_now(const models::VehicleStatus& status, const FlightSetpoint& soon,
                      const drivers::SafetyLimits& limits) {
  const double lead_s = limits.setpoint_lead_s;
  const double slack_m = 0.5 * 4.0 * lead_s * lead_s + 1e-6;
  EXPECT_NEAR(status.setpoint.x_m, soon.position_world_m.x() - lead_s * soon.velocity_world_mps.x(),
              slack_m);
  EXPECT_NEAR(status.setpoint.y_m, soon.position_world_m.y() - lead_s * soon.velocity_world_mps.y(),
              slack_m);
  const double height_m = soon.position_world_m.z() - lead_s * soon.velocity_world_mps.z();
  EXPECT_NEAR(status.setpoint_height_m, std::max(0.0, height_m), 1e-9);
  // The yaw acceleration is at most 12 rad/s², because yaw is smoothed over half a second.
  EXPECT_NEAR(wrap_to_pi(soon.yaw_rad - lead_s * soon.yaw_rate_radps - status.setpoint.yaw_rad),
              0.0, 0.5 * 12.0 * lead_s * lead_s + 1e-6);
}

TEST(VehicleStatus, ReportsSetpointAndPlan) {
  FlightBench bench(3);
  Vehicle& q1 = bench.vehicle("Q1");
  const drivers::SafetyLimits limits = drivers::limits_for(FlightBench::scenario(), "Q1");
  drivers::GuardOutput before = q1.out;
  double height_before_m = 0.0;
  double fastest_mps = 0.0;
  int on_plans = 0;
  int lifting = 0;
  int coming_down = 0;
  const auto look = [&] {
    const Time now = bench.now() - from_seconds(FlightBench::kTickS);  // time of this tick
    const models::VehicleStatus status = q1.guard->status(now);
    const FlightSetpoint& soon = q1.out.setpoint;
    EXPECT_EQ(status.stamp.time, now);
    EXPECT_EQ(status.robot, "Q1");
    EXPECT_EQ(status.state, q1.out.state);
    EXPECT_EQ(status.battery_share, q1.guard->inputs().battery_share);
    const bool is_airborne = drivers::is_airborne(q1.out.state);
    EXPECT_EQ(soon.kind, is_airborne ? FlightSetpoint::Kind::kTrack : FlightSetpoint::Kind::kNone);
    // The height set-point moves at most at the configured vertical speed.
    if (is_airborne && drivers::is_airborne(before.state)) {
      const double step_m = status.setpoint_height_m - height_before_m;
      const bool lands = q1.out.state == FlightState::kLand;
      const double most_mps = lands ? limits.descent_mps : limits.climb_mps;
      EXPECT_LE(std::abs(step_m), FlightBench::kTickS * most_mps + 1e-9);
    }
    height_before_m = status.setpoint_height_m;
    if (is_airborne) {
      expect_asked_now(status, soon, limits);
    } else {
      EXPECT_EQ(status.setpoint.position_m(), q1.guard->world_from_body().translation_m.head<2>());
    }
    fastest_mps = std::max(fastest_mps, soon.velocity_world_mps.head<2>().norm());
    // A plan that begins later is reported from its acceptance on.
    const bool flies_plan = q1.out.state == FlightState::kFollow && q1.guard->inputs().has_plan;
    if (flies_plan) {
      EXPECT_EQ(status.plan_round, q1.sent.back().round);
      ++on_plans;
    } else if (q1.out.state != FlightState::kFollow) {
      EXPECT_EQ(status.plan_round, -1);
    }
    const bool is_lifting = FlightBench::has_reason(q1, "first lift", now);
    if (is_lifting) {
      EXPECT_NEAR(q1.out.climb_to_m, limits.lift_height_m, 0.002);
      ++lifting;
    } else if (q1.out.state == FlightState::kLand) {
      EXPECT_EQ(q1.out.climb_to_m < 0.0, q1.out.is_sinking);
      coming_down += q1.out.is_sinking ? 1 : 0;
    } else if (is_airborne) {
      EXPECT_EQ(q1.out.climb_to_m, 1.0);
    }
    EXPECT_TRUE(q1.out.state == FlightState::kLand || !q1.out.is_sinking);
    // In the air no order is pending, so `changed` is set only by changes of the state, the reasons
    // or wants_armed, which becomes false near the ground.
    const bool is_other = q1.out.state != before.state || q1.out.reasons != before.reasons;
    if (is_airborne && drivers::is_airborne(before.state)) {
      EXPECT_EQ(q1.out.changed, is_other || q1.out.wants_armed != before.wants_armed);
    }
    EXPECT_TRUE(q1.out.changed || !is_other);
    before = q1.out;
  };
  while (bench.time_s() < 9.0) {
    bench.fly_up(bench.time_s() + 0.5 * FlightBench::kTickS);
    look();
  }
  EXPECT_NEAR(fastest_mps, kSpeedMaxMps, 1e-6);
  EXPECT_GT(on_plans, 300);
  EXPECT_GT(lifting, 100);
  bench.send_command(OperatorAction::kLand);
  for (int tick = 0; tick < 1'000; ++tick) {
    bench.tick();
    look();
  }
  EXPECT_GT(coming_down, 100);
  EXPECT_EQ(q1.out.state, FlightState::kIdle);
  EXPECT_FALSE(q1.out.wants_armed);
}

// When an order is revoked, the status reports all conditions against it in the order of the table.
TEST(VehicleStatus, ReportsAllReasonsOfARefusal) {
  FlightBench bench(3);
  Vehicle& q1 = bench.vehicle("Q1");
  const auto lie = [&] {
    q1.knobs.body_tilt_rad = 0.5;
    q1.knobs.yaw_offset_rad = 1.0;
  };
  bench.run(1.0, lie);
  EXPECT_FALSE(FlightBench::has_reason(q1, "arm pending", bench.now()));
  bench.send_command(OperatorAction::kArm);
  lie();
  bench.tick();
  EXPECT_TRUE(q1.out.changed) << "a new command is reported";
  lie();
  bench.tick();
  EXPECT_FALSE(q1.out.changed);
  bench.run(0.98, lie);
  EXPECT_TRUE(FlightBench::has_reason(q1, "arm pending", bench.now()));
  std::string refused = "arm refused: ";
  int names = 0;
  const auto rows = drivers::conditions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (q1.out.reasons[i]) {
      refused += (names++ > 0 ? ", " : "") + std::string(rows[i].name);
    }
  }
  EXPECT_EQ(refused, "arm refused: body tilted, attitude disagrees, yaw disagrees");
  EXPECT_FALSE(FlightBench::has_reason(q1, refused, bench.now()));
  const double wait_s = drivers::limits_for(FlightBench::scenario(), "Q1").arm_wait_s;
  bench.run(wait_s - 1.1, lie);
  EXPECT_FALSE(FlightBench::has_reason(q1, refused, bench.now()));
  bench.run(0.2, lie);
  EXPECT_TRUE(FlightBench::has_reason(q1, refused, bench.now()));
  EXPECT_FALSE(FlightBench::has_reason(q1, "arm pending", bench.now()));
}

// Plans are accepted only after the climb has come within 15 cm of its final height.
TEST(TakeOff, AcceptsPlansAfterTheClimb) {
  for (const double told_s : {-14.2, -13.9, -13.6}) {
    FlightBench bench(3);
    bench.run(0.5);
    bench.send_command(OperatorAction::kArm);
    bench.run(told_s - bench.time_s());
    bench.send_command(OperatorAction::kTakeOff);
    bench.run(0.1);
    std::vector<bool> has_plan(3, false);
    for (int tick = 0; tick < 1'800; ++tick) {
      if (tick % 10 == 0) {
        bench.send_command(OperatorAction::kFollow);
      }
      bench.tick();
      for (std::size_t i = 0; i < 3; ++i) {
        const Vehicle& vehicle = bench.vehicles()[i];
        const bool begins = vehicle.guard->inputs().has_plan && !has_plan[i];
        EXPECT_TRUE(!begins || vehicle.position_m.z() > 0.84) << vehicle.name;
        has_plan[i] = has_plan[i] || begins;
      }
    }
    EXPECT_EQ(has_plan, std::vector<bool>(3, true));
  }
}

// Without mocap and telemetry, the estimated height decreases at 0.4 of the commanded speed.
TEST(BlindDescent, EstimatesHeightWithTwoFifthsOfTheCommandedSpeed) {
  FlightBench bench(3);
  bench.fly_up(3.0);
  Vehicle& q1 = bench.vehicle("Q1");
  const auto hide = [&] {
    q1.knobs.body = {BodyFault::kOccluded};
    q1.knobs.telemetry_cut = true;
  };
  bench.run(0.8, hide);
  ASSERT_EQ(q1.out.state, FlightState::kLand);
  const auto asked_m = [&] { return q1.guard->status(bench.now()).setpoint_height_m; };
  const double begin_m = q1.guard->inputs().height_m;
  const double asked_begin_m = asked_m();
  bench.run(0.5, hide);
  ASSERT_EQ(q1.out.state, FlightState::kLand);
  const double asked_sunk_m = asked_begin_m - asked_m();
  EXPECT_GT(asked_sunk_m, 0.1);
  EXPECT_NEAR(begin_m - q1.guard->inputs().height_m, 0.4 * asked_sunk_m, 0.004);
}

}  // namespace
}  // namespace vantage::test
