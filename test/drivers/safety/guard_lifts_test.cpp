// Tests the supervision of the first lift: rise, verification of the identity, deviation from the
// path, and comparison with the autopilot.

#include <cmath>

#include <gtest/gtest.h>

#include "test/drivers/safety/one_vehicle.hpp"

namespace vantage::test {
namespace {

using models::FlightState;
using models::OperatorAction;

constexpr double kLiftM = 0.2;

// Measures the time without a rise and the time without the commanded test step.
TEST(FirstLiftWatch, MeasuresTheTimeWithoutRiseAndWithoutTestStep) {
  OneVehicle one;
  one.hold_at_height(0.0);
  one.begin_lift();
  one.run(0.98);
  EXPECT_NEAR(one.in().no_rise_s, 0.98, 1e-6);
  EXPECT_EQ(one.in().proof_pending_s, 0.0);
  one.hold_at_height(0.12);
  one.run(0.3);
  EXPECT_EQ(one.in().no_rise_s, 0.0);
  one.tracks_setpoint = false;
  one.hold_at_height(kLiftM);
  one.run(0.2);
  one.drift_mps = Eigen::Vector3d::Zero();
  one.run(1.0);
  EXPECT_GT(one.in().proof_pending_s, 0.9);
  EXPECT_LT(one.in().proof_pending_s, 1.3);
}

// A vehicle that is armed on the ground has no order to rise, so a rise counts as uncommanded. A
// body that is not seen has not risen.
TEST(FirstLiftWatch, MeasuresARiseWithoutAnOrder) {
  OneVehicle one;
  one.place_on_ground();
  one.run(1.5);
  one.send_command(OperatorAction::kArm);
  for (int i = 0; i < 100 && !one.out.wants_armed; ++i) {
    one.tick();
  }
  one.hold_at_height(0.04);  // its motors do not run yet
  one.run(0.2);
  EXPECT_EQ(one.in().unordered_rise_m, 0.0);
  one.report.armed = one.report.is_in_our_mode = true;
  one.run(0.1);
  EXPECT_NEAR(one.in().unordered_rise_m, 0.0, 1e-6);
  one.hold_at_height(0.07);
  one.run(0.5);
  EXPECT_NEAR(one.in().unordered_rise_m, 0.03, 1e-4);
  one.has_mocap = false;
  one.estimate_m = Eigen::Vector3d(0.0, 0.0, 0.08);
  one.run(0.1);
  EXPECT_NEAR(one.in().unordered_rise_m, 0.03, 1e-4);
  one.tick();
  EXPECT_EQ(one.in().unordered_rise_m, 0.0);
  OneVehicle carried;
  carried.arm();
  carried.position_m.z() = 0.3;
  carried.tick();
  EXPECT_NEAR(carried.in().unordered_rise_m, 0.3, 1e-6);
  EXPECT_FALSE(carried.in().is_found_flying) << "its motors were commanded to run";
  EXPECT_EQ(carried.state(), FlightState::kKilled);
}

// A rise of another body counts only until the vehicle's own body has risen.
TEST(FirstLiftWatch, WatchesOtherBodiesUntilTheVehicleHasRisen) {
  for (const bool has_risen : {false, true}) {
    OneVehicle one;
    one.others = {one.body("Q2", {2.0, 2.0, 0.0})};
    one.hold_at_height(0.0);
    one.begin_lift();
    one.hold_at_height(has_risen ? 0.15 : 0.0);
    one.run(0.3, [&] { one.others = {one.body("Q2", {2.0, 2.0, 0.0})}; });
    EXPECT_EQ(one.in().other_risen_m, 0.0);
    double z_m = 0.0;
    one.run(0.24, [&] {
      z_m += 0.004;
      one.others = {one.body("Q2", {2.0, 2.0, z_m})};
    });
    EXPECT_NEAR(one.in().other_risen_m, has_risen ? 0.0 : z_m - 0.004, 1e-6);
  }
}

// Measures the distance from the lift path, now and predicted for 0.2 s later.
TEST(FirstLiftWatch, MeasuresTheCurrentAndPredictedDistanceFromThePath) {
  OneVehicle one;
  one.hold_at_height(0.0);
  one.begin_lift();
  EXPECT_EQ(one.in().lift_deviation_m, 0.0);
  one.drift_mps = Eigen::Vector3d(-0.2, -0.2, 0.0);
  one.run(0.4);
  const double aside_m = one.position_m.head<2>().norm();
  EXPECT_NEAR(one.in().lift_deviation_m, aside_m + 0.2 * 0.2 * std::sqrt(2.0), 0.002);
  one.drift_mps = Eigen::Vector3d(0.2, 0.2, 0.0);
  one.run(0.2);
  EXPECT_NEAR(one.in().lift_deviation_m, one.position_m.head<2>().norm(), 0.002);
  one.drift_mps = Eigen::Vector3d::Zero();
  one.run(0.3);
  one.is_seen = false;
  one.run(0.1);
  EXPECT_NEAR(one.in().lift_deviation_m, one.position_m.head<2>().norm(), 0.002);
  one.tick();
  EXPECT_EQ(one.in().lift_deviation_m, 0.0);
}

// Compares the climb and turn rates of body and autopilot while both are reported.
TEST(FirstLiftWatch, ComparesRatesWithTheAutopilot) {
  enum class Lacks { kNothing, kPosition, kTelemetry, kPose };
  for (const Lacks lacks : {Lacks::kNothing, Lacks::kPosition, Lacks::kTelemetry, Lacks::kPose}) {
    OneVehicle one;
    one.climb_rate_error_mps = 0.2;
    one.yaw_rate_error_radps = 0.3;
    one.hold_at_height(0.0);
    one.arm();
    EXPECT_EQ(one.in().lift_climb_error_mps, 0.0);
    one.send_command(OperatorAction::kTakeOff);
    one.run(0.6);
    ASSERT_TRUE(one.lifts());
    one.drift_mps = Eigen::Vector3d(0.0, 0.0, 0.1);
    one.rises = true;
    one.turns_radps = 0.5;
    one.run(0.4);
    EXPECT_NEAR(one.in().lift_climb_error_mps, 0.2, 0.01);
    EXPECT_NEAR(one.in().lift_turn_error_radps, 0.3, 0.01);
    one.report.has_position = lacks != Lacks::kPosition;
    one.drift_mps = Eigen::Vector3d::Zero();
    one.turns_radps = 0.0;
    one.run(0.02);
    one.sends_telemetry = lacks != Lacks::kTelemetry;
    one.is_seen = lacks != Lacks::kPose;
    one.run(0.1);
    EXPECT_EQ(one.in().lift_climb_error_mps > 0.1, lacks != Lacks::kPosition);
    one.run(lacks == Lacks::kTelemetry ? 0.42 : 0.04);
    EXPECT_EQ(one.in().lift_climb_error_mps > 0.1, lacks == Lacks::kNothing);
    EXPECT_EQ(one.in().lift_turn_error_radps > 0.1, lacks == Lacks::kNothing);
  }
}

// A pose older than 0.05 s does not confirm the lift, and a short loss of poses does not end the
// climb.
TEST(FirstLiftWatch, NeedsFreshPoses) {
  for (const double late_s : {0.04, 0.06}) {
    OneVehicle one;
    one.hold_at_height(0.0);
    one.begin_lift();
    one.hold_at_height(0.1);
    one.run(0.6);
    ASSERT_TRUE(one.lifts());
    one.hold_at_height(0.18);
    one.position_m.z() = 0.18;
    one.now += from_seconds(0.02);
    one.deliver_mocap();
    one.deliver_inputs();
    one.now += from_seconds(late_s);
    one.out = one.guard.tick(one.now);
    EXPECT_EQ(one.setpoint_m().norm() > 0.1, late_s < 0.05);
  }
  OneVehicle one;
  one.begin_lift();
  one.hold_at_height(0.1);
  one.run(0.6);
  one.has_mocap = false;
  one.run(0.08);
  EXPECT_NEAR(one.in().tracking_error_m, 0.0, 1e-4);
  one.has_mocap = true;
  one.run(0.1);
  EXPECT_NEAR(one.in().tracking_error_m, 0.0, 1e-4);
}

// During a lift near the fence, the vehicle does not move away from it.
TEST(FirstLiftWatch, DoesNotMoveAwayFromTheFence) {
  scenario::Scenario room = OneVehicle::room();
  room.robots[0].start = {4.7, 0.0, 0.0};
  OneVehicle one({4.7, 0.0, 0.0}, 0.0, room);
  one.hold_at_height(0.0);
  one.begin_lift();
  ASSERT_EQ(one.state(), FlightState::kHold);
  one.run(1.0, [&] { EXPECT_NEAR(one.setpoint_m().x(), 4.7, 1e-6); });
}

}  // namespace
}  // namespace vantage::test
