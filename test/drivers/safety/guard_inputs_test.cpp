// Tests the inputs that the guard computes at a tick from the received messages, as returned by
// inputs().

#include <cmath>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "test/drivers/safety/one_vehicle.hpp"

namespace vantage::test {
namespace {

using drivers::kNever;
using models::FlightState;
using models::OperatorAction;

// The height comes from mocap. When the last pose is older than 0.1 s, the height comes from the
// autopilot if its position is valid; otherwise from the last pose.
TEST(GuardInputs, UseTheBestHeightSource) {
  enum class Lacks { kNothing, kPosition, kEstimator, kTelemetry };
  for (const Lacks lacks :
       {Lacks::kNothing, Lacks::kPosition, Lacks::kEstimator, Lacks::kTelemetry}) {
    OneVehicle one({0.4, -0.7, 1.5});
    one.run(0.4);
    one.drift_mps = Eigen::Vector3d::Zero();
    one.estimate_m = Eigen::Vector3d(0.45, -0.75, 1.6);
    one.run(0.1);
    EXPECT_NEAR(one.in().height_m, 1.5, 1e-6);
    one.report.has_position = lacks != Lacks::kPosition;
    one.report.estimator_good = lacks != Lacks::kEstimator;
    one.sends_telemetry = lacks != Lacks::kTelemetry;
    one.tick();
    one.has_mocap = false;
    one.run(0.1);
    EXPECT_NEAR(one.in().height_m, 1.5, 1e-6) << "0.1 s ago it was seen";
    one.tick();
    const double felt_m = lacks == Lacks::kNothing || lacks == Lacks::kTelemetry ? 1.6 : 1.5;
    EXPECT_NEAR(one.in().height_m, felt_m, 1e-6) << static_cast<int>(lacks);
    one.run(0.36);  // a report up to 0.5 s old is accepted
    EXPECT_NEAR(one.in().height_m, felt_m, 1e-6) << static_cast<int>(lacks);
    one.run(0.04);
    EXPECT_NEAR(one.in().height_m, lacks == Lacks::kNothing ? 1.6 : 1.5, 1e-6);
    one.has_mocap = true;
    one.tick();
    EXPECT_NEAR(one.in().height_m, 1.5, 1e-6) << "seen again";
  }
}

// The tracking error includes the height error in both directions, also in the flight after a
// landing.
TEST(GuardInputs, MeasureTheHeightErrorInEveryFlight) {
  for (const bool is_second : {false, true}) {
    for (const double off_m : {-0.3, 0.3}) {
      OneVehicle one({0.4, -0.7, 1.5});
      one.run(0.4);
      if (is_second) {
        one.send_command(OperatorAction::kLand);
        one.run(5.0);
        EXPECT_LT(one.position_m.z(), 0.05);
        one.report.armed = false;
        one.run(0.5);
        ASSERT_EQ(one.state(), FlightState::kIdle);
        one.report.armed = true;
        one.position_m.z() = 1.5;
        one.run(0.4);
        ASSERT_EQ(one.state(), FlightState::kHold);
      }
      one.drift_mps = Eigen::Vector3d(0.0, 0.0, off_m);
      one.run(1.0);
      EXPECT_NEAR(one.in().tracking_error_m, 0.3, 0.01) << is_second;
    }
  }
}

// A disarmed report in the air does not reset the reference height of the ground.
TEST(GuardInputs, KeepTheGroundHeightInTheAir) {
  OneVehicle one({0.4, -0.7, 1.5});
  one.run(0.4);
  one.report.armed = false;
  one.run(0.2);
  EXPECT_EQ(one.state(), FlightState::kHold);
  one.has_mocap = false;
  one.run(0.2);
  EXPECT_EQ(one.state(), FlightState::kIdle) << "without a pose the report is accepted";
  one.report.armed = one.has_mocap = true;
  one.tick();
  EXPECT_TRUE(one.in().is_found_flying);
}

// The height error is ignored during a descent. It counts while a landing is waiting.
TEST(GuardInputs, IgnoreTheHeightErrorWhileSinking) {
  for (const bool waits : {false, true}) {
    OneVehicle one({0.0, 0.0, 1.5});
    const auto walker = [&] {
      if (waits) {
        one.others = {one.body("W1", {-0.1, 0.0, 0.2})};
      }
    };
    walker();
    one.run(0.4, walker);
    one.send_command(OperatorAction::kLand);
    one.tick();
    EXPECT_EQ(one.out.is_sinking, !waits);
    one.tracks_setpoint = false;
    one.drift_mps = Eigen::Vector3d(0.0, 0.0, 0.5);
    one.run(0.4, walker);
    EXPECT_EQ(one.in().tracking_error_m > 0.15, waits);
    EXPECT_EQ(one.in().tracking_error_m < 0.01, !waits);
  }
}

// A disarmed report is rejected while mocap shows the body in flight: higher than 0.15 m and not
// falling at 1 m/s.
TEST(GuardInputs, RejectDisarmedReportsInFlight) {
  struct Case {
    double height_m, sinks_mps;
    bool flies;
  };
  for (const Case& c : {Case{1.5, 0.0, true}, Case{1.5, 0.8, true}, Case{1.5, 1.2, false},
                        Case{0.16, 0.0, true}, Case{0.14, 0.0, false}}) {
    OneVehicle one({0.3, 0.05, 1.5});
    one.run(0.4);
    one.drift_mps = Eigen::Vector3d(0.0, 0.0, -0.5);
    one.run(std::round((1.5 - c.height_m) / 0.5 / 0.02) * 0.02);
    one.drift_mps = Eigen::Vector3d(0.0, 0.0, -c.sinks_mps);
    if (c.height_m < 1.0) {
      one.position_m.z() = c.height_m;
    }
    one.run(0.3);
    ASSERT_TRUE(one.in().autopilot_armed);
    one.report.armed = false;
    one.tick();
    one.tick();
    EXPECT_EQ(one.in().autopilot_armed, c.flies) << c.height_m << " " << c.sinks_mps;
    one.run(0.2);
    EXPECT_EQ(one.in().autopilot_armed, c.flies);
    one.has_mocap = false;
    one.run(0.06);
    EXPECT_EQ(one.in().autopilot_armed, c.flies) << "seen 0.06 s ago";
    one.has_mocap = true;
    one.report.armed = true;
    one.run(0.1);
    EXPECT_TRUE(one.in().autopilot_armed || !c.flies);
  }
}

// Without mocap, the disarmed state is accepted after three consecutive heartbeats report it; an
// armed report in between restarts the count.
TEST(GuardInputs, NeedThreeHeartbeatsToDisarmWithoutMocap) {
  OneVehicle one({0.3, 3.0, 1.5});
  one.run(0.4);
  one.has_mocap = false;
  one.sends_heartbeats = false;
  one.run(0.2);
  const auto beat = [&] {
    one.sends_heartbeats = true;
    one.tick();
    one.sends_heartbeats = false;
    one.tick();
  };
  for (int time = 0; time < 2; ++time) {
    one.report.armed = false;
    one.tick();
    EXPECT_TRUE(one.in().autopilot_armed);
    for (int beats = 1; beats <= 2; ++beats) {
      beat();
      EXPECT_TRUE(one.in().autopilot_armed) << beats;
    }
    if (time == 0) {  // restarts the count
      one.report.armed = true;
      one.tick();
      beat();
    }
  }
  beat();
  EXPECT_FALSE(one.in().autopilot_armed);
}

// On the ground, armed and disarmed reports are accepted immediately.
TEST(GuardInputs, AcceptArmedReportsAtOnceOnTheGround) {
  OneVehicle one;
  one.place_on_ground();
  one.run(0.2);
  for (int time = 0; time < 2; ++time) {
    EXPECT_FALSE(one.in().autopilot_armed);
    one.report.armed = true;
    one.tick();
    EXPECT_TRUE(one.in().autopilot_armed);
    one.report.armed = false;
    one.tick();
    EXPECT_FALSE(one.in().autopilot_armed);
  }
  one.position_m.z() = 1.0;  // carried by a person
  one.report.armed = true;
  one.has_mocap = false;
  one.tick();
  one.report.armed = false;
  one.has_mocap = true;
  one.tick();
  EXPECT_FALSE(one.in().autopilot_armed) << "carried, not flown";
}

// In the air, the age of an input that never arrived counts from the start of the process. On the
// ground it is kNever.
TEST(GuardInputs, MeasureAgesOfMissingInputsFromTheStart) {
  OneVehicle one({0.3, 0.05, 1.5});
  one.has_mocap = one.sends_heartbeats = one.is_commanded = false;
  one.battery_share.reset();
  one.report.is_in_our_mode = false;
  one.run(0.7);
  for (const double age_s : {one.in().pose_age_s, one.in().heartbeat_age_s, one.in().operator_age_s,
                             one.in().battery_age_s}) {
    EXPECT_EQ(age_s, kNever);
  }
  EXPECT_EQ(one.in().battery_unchanged_s, 0.0);
  one.report.is_in_our_mode = true;
  for (int tick = 1; tick < 20; ++tick) {
    one.tick();
    for (const double age_s : {one.in().pose_age_s, one.in().heartbeat_age_s,
                               one.in().operator_age_s, one.in().battery_age_s}) {
      EXPECT_NEAR(age_s, 0.68 + 0.02 * tick, 1e-9);
    }
    EXPECT_EQ(one.in().battery_unchanged_s, 0.0);
    EXPECT_EQ(one.in().speed_mps, 0.0);
  }
  OneVehicle landing({0.3, 0.05, 1.5});
  landing.report.is_in_our_mode = false;
  landing.report.is_landing_itself = true;
  landing.is_commanded = false;
  landing.tick();
  EXPECT_TRUE(landing.in().is_found_landing);
  EXPECT_EQ(landing.in().operator_age_s, 0.0);
  OneVehicle mute({0.3, 0.05, 1.5});
  mute.sends_telemetry = false;
  mute.run(0.1);
  EXPECT_EQ(mute.in().telemetry_age_s, kNever);
}

// Tests the ages of the received inputs. The age of the battery value counts in flight only.
TEST(GuardInputs, MeasureAges) {
  OneVehicle one({0.3, 0.05, 1.5});
  one.report.is_in_our_mode = false;
  one.run(1.0);
  EXPECT_EQ(one.in().flight_s, 0.0);
  EXPECT_EQ(one.in().battery_unchanged_s, 0.0) << "on the ground";
  one.report.is_in_our_mode = true;
  one.tick();
  one.run(1.0);
  EXPECT_NEAR(one.in().flight_s, 1.0, 1e-9);
  EXPECT_NEAR(one.in().battery_unchanged_s, 1.0, 1e-9) << "counts from the start of the flight";
  one.battery_share = 0.89;
  one.run(0.5);
  EXPECT_NEAR(one.in().battery_unchanged_s, 0.48, 1e-9);
  one.battery_share.reset();
  one.sends_heartbeats = one.sends_telemetry = false;
  one.run(0.3);
  EXPECT_NEAR(one.in().battery_age_s, 0.3, 1e-9);
  EXPECT_NEAR(one.in().heartbeat_age_s, 0.3, 1e-9);
  EXPECT_NEAR(one.in().telemetry_age_s, 0.3, 1e-9);
  EXPECT_NEAR(one.in().flight_s, 1.8, 1e-9);
}

// Measures the horizontal speed while the vehicle is seen.
TEST(GuardInputs, MeasureTheSpeedWhileSeen) {
  OneVehicle one({0.3, 0.05, 1.5});
  one.run(0.4);
  one.drift_mps = Eigen::Vector3d(0.3, -0.4, 0.2);
  one.run(0.5);
  EXPECT_NEAR(one.in().speed_mps, 0.5, 1e-3);
  EXPECT_GT(one.in().tracking_error_m, 0.2);
  one.has_mocap = false;
  one.run(0.12);
  EXPECT_EQ(one.in().speed_mps, 0.0);
  EXPECT_EQ(one.in().tracking_error_m, 0.0);
  OneVehicle carried;
  carried.place_on_ground();
  carried.drift_mps = Eigen::Vector3d(0.3, 0.0, 0.0);
  carried.run(1.0);
  EXPECT_EQ(carried.in().tracking_error_m, 0.0) << "no set-point on the ground";
}

// Late poses slow the clock of the plan. The resulting delay of the vehicle counts as tracking
// error.
TEST(GuardInputs, MeasureTheDelayBehindThePlan) {
  OneVehicle one({0.0, 0.0, 1.5});
  one.hover_without_plan();
  ASSERT_EQ(one.follow(1.0, 0.0, 4.0, 1.5), drivers::PlanVerdict::kAccepted);
  one.run(1.0);
  EXPECT_NEAR(one.in().tracking_error_m, 0.0, 0.01);
  for (int i = 0; i < 8; ++i) {  // seen at every fifth tick, so the plan clock's rate is 0.68
    one.has_mocap = false;
    one.run(0.08);
    one.has_mocap = true;
    one.tick();
  }
  const double late_m = 1.0 * (1.0 + 0.8) - one.position_m.x();
  EXPECT_GT(late_m, 0.1);
  EXPECT_NEAR(one.in().tracking_error_m, late_m, 0.03);
}

// The position is compared with the start position of the scenario only before the first flight.
TEST(GuardInputs, MeasureTheDistanceFromTheStartBeforeTheFirstFlight) {
  scenario::Scenario room = OneVehicle::room();
  room.robots[0].start = {1.0, -1.0, 3.0};
  OneVehicle one({1.3, -1.4, 0.0}, -3.1, room);
  one.tick();
  EXPECT_GT(one.in().start_off_m, 0.0);
  one.place_on_ground();
  one.run(0.1);
  EXPECT_NEAR(one.in().start_off_m, 0.5, 1e-6);
  EXPECT_NEAR(one.in().start_turn_rad, 2.0 * kPi - 6.1, 1e-6);
  for (int time = 0; time < 2; ++time) {
    one.position_m = {1.3, -1.4, 1.0};
    one.report.armed = one.report.is_in_our_mode = true;
    one.run(0.1);
    EXPECT_EQ(one.state(), FlightState::kHold);
    EXPECT_EQ(one.in().start_off_m, 0.0);
    EXPECT_EQ(one.in().start_turn_rad, 0.0);
    one.drift_mps = Eigen::Vector3d(0.0, 0.0, -1.0);
    one.run(1.0);
    one.drift_mps = Eigen::Vector3d::Zero();
    one.place_on_ground();
    one.run(0.5);
    one.drift_mps.reset();
    EXPECT_EQ(one.state(), FlightState::kIdle);
    EXPECT_EQ(one.in().start_off_m, 0.0) << "the vehicle has flown";
  }
  drivers::SafetyLimits anywhere = drivers::limits_for(room, "Q1");
  anywhere.start.reset();
  OneVehicle free({1.3, -1.4, 0.0}, -3.1, room, "Q1", anywhere);
  free.place_on_ground();
  free.run(0.1);
  EXPECT_EQ(free.in().start_off_m, 0.0);
  OneVehicle unseen({1.3, -1.4, 0.0}, -3.1, room);
  unseen.place_on_ground();
  unseen.has_mocap = false;
  unseen.run(0.1);
  EXPECT_EQ(unseen.in().start_off_m, 0.0);
  EXPECT_EQ(unseen.in().body_tilt_rad, 0.0);
}

// near_m is the least distance to any passing body within the next second.
TEST(GuardInputs, MeasureTheDistanceToPassingBodies) {
  OneVehicle one;
  one.place_on_ground();
  one.run(0.2, [&] { one.others = {one.body("W1", {3.0, 0.5, 0.0})}; });
  EXPECT_NEAR(one.in().near_m, std::hypot(3.0, 0.5), 1e-3);
  double x_m = 3.0;
  one.run(0.5, [&] {
    x_m -= 0.02;
    one.others = {one.body("W1", {x_m, 0.5, 0.0})};
  });
  EXPECT_NEAR(one.in().near_m, std::hypot(x_m + 0.02 - 1.0, 0.5), 0.02);
}

// The autopilot's estimate is compared with mocap only while both are fresh.
TEST(GuardInputs, CompareTheEstimateOnlyWhileFresh) {
  for (const int lacks : {0, 1, 2, 3, 4}) {
    OneVehicle one({0.3, 0.05, 1.5});
    one.run(0.4);
    one.estimate_m = Eigen::Vector3d(0.3, 0.05, 1.7);
    one.run(0.1);
    EXPECT_NEAR(one.in().estimate_error_m, 0.2, 1e-6);
    one.report.has_position = lacks != 1;
    one.report.estimator_good = lacks != 2;
    one.sends_telemetry = lacks != 3;
    one.tick();
    one.has_mocap = lacks != 4;
    one.run(0.06);
    if (lacks == 3) {
      EXPECT_NEAR(one.in().estimate_error_m, 0.2, 1e-6);
      one.run(0.46);
    }
    EXPECT_NEAR(one.in().estimate_error_m, lacks == 0 ? 0.2 : 0.0, 1e-6) << lacks;
  }
}

}  // namespace
}  // namespace vantage::test
