// Tests flights of the driver with emulated autopilots of both dialects in virtual time.

#include <algorithm>
#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "test/drivers/quadrotor/flight_bench.hpp"
#include "wire/mavlink/constants.hpp"

namespace vantage::drivers {
namespace {

using models::AutopilotDialect;
using models::FlightState;
using models::OperatorAction;
using test::FlightBench;

class Flight : public ::testing::TestWithParam<AutopilotDialect> {
 protected:
  FlightBench bench{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Dialects, Flight,
                         ::testing::Values(AutopilotDialect::kPx4, AutopilotDialect::kArdupilot),
                         [](const auto& chosen) { return std::string(name_of(chosen.param)); });

TEST_P(Flight, TakesOffHoldsAndLands) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  EXPECT_EQ(bench.state(), FlightState::kHold);
  bench.run(5.0);
  const Eigen::Vector3d place_m = bench.vehicle.world_from_body().translation_m;
  EXPECT_LT((place_m.head<2>() - Eigen::Vector2d(2.0, 2.0)).norm(), 0.15);
  EXPECT_LT(bench.height_error_m(), 0.1);
  bench.command(OperatorAction::kLand);
  ASSERT_TRUE(bench.run_until([this] { return !bench.is_armed(); }, 30.0)) << bench.reasons();
  bench.run(2.0);
  EXPECT_EQ(bench.state(), FlightState::kIdle);
  EXPECT_NEAR(bench.vehicle.world_from_body().translation_m.z(), FlightBench::kFloorM, 1e-9);
}

TEST_P(Flight, LandsDuringItsTakeOff) {
  for (const double up_to_m : {0.1, 0.3, 0.5, 0.8}) {
    SCOPED_TRACE(up_to_m);
    const auto height_m = [this] { return bench.vehicle.world_from_body().translation_m.z(); };
    ASSERT_TRUE(bench.run_until(
        [this] {
          return bench.now > FlightBench::kStart + from_seconds(1.0) && bench.reasons().empty();
        },
        20.0));
    bench.command(OperatorAction::kArm);
    ASSERT_TRUE(bench.run_until([this] { return bench.is_armed(); }, 60.0));
    bench.run(1.5);
    bench.command(OperatorAction::kTakeOff);
    ASSERT_TRUE(bench.run_until([&] { return height_m() > up_to_m; }, 15.0));
    bench.command(OperatorAction::kLand);
    double highest_m = 0.0;
    bench.on_step = [&](Time) { highest_m = std::max(highest_m, height_m()); };
    ASSERT_TRUE(bench.run_until([this] { return !bench.is_armed(); }, 20.0)) << bench.reasons();
    bench.on_step = nullptr;
    EXPECT_LT(highest_m, up_to_m + 0.2);
    bench.run(5.0);
  }
}

// A person walks in during the descent and stays below. The vehicle stops, moves aside and lands.
TEST_P(Flight, LandsNextToAPerson) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.walker_m = Eigen::Vector3d(3.0, 2.0, 0.0);
  bench.run(3.0);
  bool walks = false;
  double closest_m = 9.0;
  bench.on_step = [&](Time) {
    const Eigen::Vector3d at_m = bench.vehicle.world_from_body().translation_m;
    const double away_m = (at_m - *bench.walker_m).head<2>().norm();
    walks = (walks || at_m.z() < 0.75) && away_m > 0.3;
    bench.walker_m->x() -= walks ? 0.5 * to_seconds(FlightBench::kTick) : 0.0;
    closest_m = std::min(closest_m, (at_m - *bench.walker_m).norm());
  };
  bench.command(OperatorAction::kLand);
  ASSERT_TRUE(bench.run_until([this] { return !bench.is_armed(); }, 60.0)) << bench.reasons();
  EXPECT_LT(bench.walker_m->x(), 2.5);
  EXPECT_GT(closest_m, 0.45);
}

/// Returns a plan at 0.6 m/s: straight, left turn, right turn, and a stop.
models::RobotPlan curve(FlightBench& bench) {
  const Pose2 start = flatten(bench.vehicle.world_from_body());
  std::vector<models::PlanSegment> segments{{{0.6, 0.0}, 2.0, 0.0},
                                            {{0.6, 1.0}, 1.5, 0.0},
                                            {{0.6, -1.0}, 1.5, 0.0},
                                            {{0.6, 0.0}, 1.0, 0.0}};
  for (const models::PlanSegment& stop : models::brake(0.6, 2.0)) {
    segments.push_back(stop);
  }
  return bench.plan(start, segments, std::chrono::milliseconds(500));
}

TEST_P(Flight, FollowsAPlanToItsHover) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.run(3.0);
  bench.command(OperatorAction::kFollow);
  bench.run(0.1);
  const models::RobotPlan plan = curve(bench);
  bench.driver->on_plan(plan, bench.now);
  double worst_m = 0.0;
  bench.on_step = [&](Time now) {
    const Pose2 planned = models::at(plan.trajectory, now).world_from_body;
    const Pose2 is = flatten(bench.vehicle.world_from_body());
    worst_m = std::max(worst_m, (planned.position_m() - is.position_m()).norm());
  };
  bench.run(2.0);
  EXPECT_EQ(bench.state(), FlightState::kFollow) << bench.reasons();
  EXPECT_EQ(bench.status().plan_round, plan.round);
  bench.run(9.0);
  const Pose2 end = models::at(plan.trajectory, bench.now).world_from_body;
  const Pose2 is = flatten(bench.vehicle.world_from_body());
  EXPECT_LT((end.position_m() - is.position_m()).norm(), 0.1);
  EXPECT_LT(std::abs(wrap_to_pi(end.yaw_rad - is.yaw_rad)), 0.1);
  EXPECT_LT(worst_m, 0.4) << "a larger error would cause a hold";
  EXPECT_LT(bench.height_error_m(), 0.1);
  RecordProperty("worst_mm", static_cast<int>(1000.0 * worst_m));
}

/// Returns the type masks of the set-points in the datagrams `sent`.
std::set<std::uint16_t> sent_type_masks(const std::vector<std::vector<std::uint8_t>>& sent) {
  std::set<std::uint16_t> out;
  wire::mavlink::Parser parser;
  for (const auto& datagram : sent) {
    parser.feed(datagram, [&](const wire::mavlink::Frame& frame) {
      if (const auto setpoint =
              wire::mavlink::unpack<wire::mavlink::SetPositionTargetLocalNed>(frame)) {
        out.insert(setpoint->type_mask);
      }
    });
  }
  return out;
}

// Regression: at a HOLD in motion, a real ArduCopter overshot by one metre. The driver sent one
// kind of set-point to a moving vehicle and another kind to a stationary one. At each change of the
// kind, ArduCopter attributes its present braking to wind
// (RecordedMotion.OvershootsAsRecordedWhenTheTargetKindChanges verifies this for the emulator). The
// driver must send one kind for the whole flight. The vehicle must stop within the budgeted
// distance and stay there, also after a second HOLD.
TEST_P(Flight, StopsWithinTheBudgetedDistance) {
  constexpr double kRecordedM = 0.12;  // m; accuracy of the emulated autopilots
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.run(3.0);
  std::set<std::uint16_t> kinds;
  Eigen::Vector2d from_m = bench.place_m();
  double farthest_m = 0.0;
  double back_m = 0.0;
  bench.on_step = [&](Time) {
    kinds.merge(sent_type_masks(bench.sent));
    const double away_m = (bench.place_m() - from_m).norm();
    farthest_m = std::max(farthest_m, away_m);
    back_m = std::max(back_m, farthest_m - away_m);
  };
  const SafetyLimits limits = limits_for(bench.scenario, "Q1");
  for (const char* const time : {"first", "once more"}) {
    SCOPED_TRACE(time);
    ASSERT_TRUE(bench.follow_straight(limits.vehicle.speed_max_mps)) << bench.reasons();
    const double speed_mps = bench.speed_mps();
    from_m = bench.place_m();
    farthest_m = back_m = 0.0;
    bench.command(OperatorAction::kHold);
    bench.run(3.0);
    EXPECT_EQ(bench.state(), FlightState::kHold) << bench.reasons();
    EXPECT_LT(farthest_m, stopping_distance_m(limits, speed_mps) + kRecordedM)
        << "from " << speed_mps;
    EXPECT_GT(farthest_m, 0.1) << "the vehicle was not in motion";
    EXPECT_LT(back_m, kRecordedM) << "the vehicle overshoots";
    EXPECT_LT(bench.speed_mps(), 0.1);
  }
  EXPECT_EQ(kinds, std::set<std::uint16_t>{wire::mavlink::mask::kNothingIgnored});
}

TEST_P(Flight, HoldsThenLandsWithoutPoses) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.command(OperatorAction::kFollow);
  bench.run(0.1);
  bench.driver->on_plan(curve(bench), bench.now);
  ASSERT_TRUE(bench.run_until([&] { return bench.state() == FlightState::kFollow; }, 3.0));
  bench.run(1.0);
  bench.has_mocap = false;
  bench.run(0.2);
  EXPECT_EQ(bench.state(), FlightState::kHold) << bench.reasons();
  bench.run(0.4);
  EXPECT_EQ(bench.state(), FlightState::kLand) << bench.reasons();
  ASSERT_TRUE(bench.run_until([&] { return !bench.is_armed(); }, 30.0)) << bench.reasons();
  bench.run(1.0);  // near the floor flight safety stops the motors
  EXPECT_NEAR(bench.vehicle.world_from_body().translation_m.z(), FlightBench::kFloorM, 1e-9);
}

TEST_P(Flight, StopsTheMotorsImmediatelyOnAnEmergencyStop) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.command(OperatorAction::kEmergencyStop);
  bench.run(0.03);
  EXPECT_FALSE(bench.is_armed());
  bench.run(3.0);
  EXPECT_EQ(bench.state(), FlightState::kKilled);
  bench.command(OperatorAction::kTakeOff);
  bench.run(3.0);
  EXPECT_FALSE(bench.is_armed());
}

// The emergency stop is sent at many times from the ground to the end of the climb, including
// directly after arming, before a heartbeat reports the armed state. The motors stop immediately
// and run again only after `arm`.
TEST_P(Flight, StopsTheMotorsImmediatelyDuringTakeOff) {
  for (const double above_m : {-1.0, 0.02, 0.1, 0.3, 0.8}) {
    SCOPED_TRACE(above_m);
    FlightBench up(GetParam());
    const auto height_m = [&up] {
      return up.vehicle.world_from_body().translation_m.z() - FlightBench::kFloorM;
    };
    ASSERT_TRUE(up.run_until(
        [&up] { return up.now > FlightBench::kStart + from_seconds(1.0) && up.reasons().empty(); },
        20.0));
    up.command(OperatorAction::kArm);
    ASSERT_TRUE(up.run_until([&up] { return up.is_armed(); }, 60.0)) << up.reasons();
    if (above_m > 0.0) {
      up.run(1.5);  // the heartbeat reports the armed state up to a second later
      up.command(OperatorAction::kTakeOff);
      ASSERT_TRUE(up.run_until([&] { return height_m() > above_m; }, 15.0)) << up.reasons();
    }
    up.command(OperatorAction::kEmergencyStop);
    up.run(0.03);
    EXPECT_FALSE(up.is_armed());
    EXPECT_EQ(up.state(), FlightState::kKilled);
    up.command(OperatorAction::kTakeOff);
    bool has_run = false;
    up.on_step = [&](Time) { has_run = has_run || up.is_armed(); };
    up.run(3.0);
    EXPECT_FALSE(has_run);
    EXPECT_EQ(up.state(), FlightState::kKilled);
    EXPECT_NEAR(height_m(), 0.0, 1e-9);
  }
}

TEST_P(Flight, YieldsToAPilotUntilCommanded) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  const std::uint32_t ours = bench.vehicle.controller().mode();
  const bool is_px4 = GetParam() == AutopilotDialect::kPx4;
  bench.vehicle.controller().set_mode(is_px4 ? 3U << 16U : 5U, bench.now);
  bench.run(4.0);
  EXPECT_NE(bench.vehicle.controller().mode(), ours) << "the driver fought the pilot";
  EXPECT_EQ(bench.state(), FlightState::kHold);
  EXPECT_TRUE(bench.has_reason("mode; send `hold`, `follow` or `land` to regain control"))
      << bench.reasons();
  bench.command(OperatorAction::kFollow);
  ASSERT_TRUE(bench.run_until([&] { return bench.vehicle.controller().mode() == ours; }, 3.0));
  bench.run(1.5);
  EXPECT_FALSE(bench.has_reason("to regain control")) << bench.reasons();
}

TEST_P(Flight, IsLandedByTheAutopilotWhenTheLinkIsCut) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.is_wire_cut = true;
  bench.run(4.0);
  EXPECT_EQ(bench.state(), FlightState::kLand);
  EXPECT_TRUE(bench.has_reason("messages have stopped")) << bench.reasons();
  ASSERT_TRUE(bench.run_until([&] { return !bench.is_armed(); }, 40.0));
}

// Regression: a driver restarted in flight reported `idle` and landed the vehicle although the
// operator had not commanded it.
TEST_P(Flight, RestartedDriverHoldsAFlyingVehicle) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.run(2.0);  // until it hovers, because the autopilot completes its climb first
  const Eigen::Vector3d place_m = bench.vehicle.world_from_body().translation_m;
  bench.restart_driver();
  ASSERT_TRUE(bench.run_until([&] { return bench.state() == FlightState::kHold; }, 2.0))
      << bench.reasons();
  bench.run(5.0);
  EXPECT_EQ(bench.state(), FlightState::kHold) << bench.reasons();
  EXPECT_TRUE(bench.has_reason("found flying"));
  EXPECT_LT((bench.vehicle.world_from_body().translation_m - place_m).norm(), 0.3);
  bench.has_operator = false;
  ASSERT_TRUE(bench.run_until([&] { return !bench.is_armed(); }, 40.0)) << bench.reasons();
}

// Without mocap, the restarted driver lands the vehicle.
TEST_P(Flight, RestartedDriverLandsAnUnseenVehicle) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.restart_driver();
  bench.has_mocap = false;
  ASSERT_TRUE(bench.run_until([&] { return !bench.is_armed(); }, 40.0)) << bench.reasons();
}

TEST_P(Flight, ReportsTheWrongDialect) {
  const AutopilotDialect other =
      GetParam() == AutopilotDialect::kPx4 ? AutopilotDialect::kArdupilot : AutopilotDialect::kPx4;
  FlightBench mixed(GetParam(), FlightBench::vehicle_for(other));
  mixed.run(5.0);
  EXPECT_TRUE(mixed.has_reason("the autopilot is not")) << mixed.reasons();
  mixed.command(OperatorAction::kArm);
  mixed.run(30.0);
  EXPECT_FALSE(mixed.is_armed());
}

TEST_P(Flight, ReportsWhyTheAutopilotRefusesToArm) {
  bench.run(10.0);
  ASSERT_EQ(bench.reasons(), "");
  bench.vehicle.controller().set_fault("Preflight Fail: Accel 0 clipping");
  bench.command(OperatorAction::kArm);
  ASSERT_TRUE(bench.run_until([&] { return bench.has_reason("arm "); }, 5.0)) << bench.reasons();
  EXPECT_TRUE(bench.has_reason(GetParam() == AutopilotDialect::kPx4
                                   ? "arm temporarily rejected: Preflight Fail: Accel 0 clipping"
                                   : "arm failed: "))
      << bench.reasons();
  EXPECT_FALSE(bench.is_armed());
}

// Regression, seen with ArduCopter: the driver repeated the take-off command during the lift and
// the autopilot refused it. Every vehicle then reported "take-off failed" for 5 s while it followed
// its first plan.
TEST_P(Flight, HidesARefusedTakeOffOnceAirborne) {
  bool has_said = false;
  bench.on_step = [&](Time now) {
    wire::mavlink::CommandAck ack;
    ack.command = wire::mavlink::command::kTakeOff;
    ack.result = 4;
    std::vector<std::uint8_t> bytes;
    wire::mavlink::append_bytes(
        wire::mavlink::pack(ack, {1, wire::mavlink::kComponentAutopilot, 0}), bytes);
    bench.driver->receive(bytes, true, now);
    has_said = has_said || bench.has_reason("take-off failed");
  };
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  EXPECT_EQ(has_said, GetParam() == AutopilotDialect::kArdupilot) << "PX4 accepts no such command";
  EXPECT_FALSE(bench.has_reason("take-off failed")) << bench.reasons();
}

TEST_P(Flight, IsReproducible) {
  ASSERT_TRUE(bench.take_off());
  FlightBench again(GetParam());
  ASSERT_TRUE(again.take_off());
  EXPECT_EQ(again.now, bench.now);
  EXPECT_EQ(again.sent, bench.sent);
  EXPECT_EQ(again.vehicle.world_from_body().translation_m,
            bench.vehicle.world_from_body().translation_m);
}

}  // namespace
}  // namespace vantage::drivers
