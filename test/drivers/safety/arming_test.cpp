// Tests the conditions that forbid arming and taking off, and the handling of orders while they are
// forbidden.

#include <cmath>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::test {
namespace {

using models::FlightState;
using models::OperatorAction;

constexpr double kDegree = kPi / 180.0;
constexpr double kSettledS = 1.0 - FlightBench::kLeadS;

class Arming : public testing::Test {
 protected:
  Arming() : q1(bench.vehicle("Q1")) {}
  bool has(const std::string& reason) { return FlightBench::has_reason(q1, reason, bench.now()); }
  /// Stays on the ground for 1 s with the knobs, commands `arm` and runs 0.5 s more.
  void arm(const std::function<void()>& set_knobs = [] {}) {
    bench.run(1.0, set_knobs);
    set_knobs();
    bench.send_command(OperatorAction::kArm);
    bench.tick();
    bench.run(0.5, set_knobs);
  }
  FlightBench bench{5};
  Vehicle& q1;
};

// Regression: a vehicle armed while mocap showed it lying on its side, and flew away.
TEST_F(Arming, IsForbiddenWhenTheBodyIsTilted) {
  for (const double tilt_rad : {16.0 * kDegree, -16.0 * kDegree, 90.0 * kDegree, kPi}) {
    arm([&] { q1.knobs.body_tilt_rad = q1.knobs.attitude_offset_rad = tilt_rad; });
    EXPECT_FALSE(q1.is_armed) << tilt_rad;
    EXPECT_TRUE(has("body tilted"));
  }
  EXPECT_TRUE(bench.vehicle("Q2").is_armed);
}

TEST_F(Arming, IsForbiddenWhileTheHostIsBusy) {
  arm([&] { q1.knobs.processor_wait_s = 0.16; });
  EXPECT_FALSE(q1.is_armed);
  EXPECT_TRUE(has("host busy"));
  EXPECT_TRUE(has("arm pending"));
  bench.run(1.0, [&] { q1.knobs.processor_wait_s = 0.15; });
  EXPECT_TRUE(q1.is_armed) << "the command is kept until the host has time";
}

// Regression, seen in a simulated flight: with a rotated mocap world a vehicle took off. It hit an
// obstacle that its map had at another position.
TEST_F(Arming, IsForbiddenAwayFromTheStart) {
  const Eigen::Vector3d start_m = q1.position_m;
  const double start_yaw_rad = q1.yaw_rad;
  for (const double side : {-1.0, 1.0}) {
    for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0)}) {
      q1.position_m = start_m + 0.53 * side * axis;
      arm();
      EXPECT_FALSE(q1.is_armed) << (side * axis).transpose();
      EXPECT_TRUE(has("not at its start"));
    }
    q1.position_m = start_m;
    q1.yaw_rad = start_yaw_rad + 0.33 * side;
    arm();
    EXPECT_FALSE(q1.is_armed) << side;
    EXPECT_TRUE(has("not at its start"));
    q1.yaw_rad = start_yaw_rad;
  }
  q1.position_m = start_m + Eigen::Vector3d(0.0, 0.47, 0.0);
  q1.yaw_rad = start_yaw_rad - 0.27;
  arm();
  EXPECT_TRUE(q1.is_armed);
}

TEST_F(Arming, IsAllowedAtTheLandingPositionAfterAFlight) {
  arm();
  bench.send_command(OperatorAction::kTakeOff);
  bench.run(20.0);
  ASSERT_EQ(q1.out.state, FlightState::kHold);
  bench.send_command(OperatorAction::kLand);
  bench.run(15.0);
  ASSERT_FALSE(q1.is_armed);
  q1.position_m.y() += 0.8;  // carried by a person
  bench.run(3.0);
  arm();
  EXPECT_TRUE(q1.is_armed);
}

TEST_F(Arming, IsAllowedOnASlope) {
  arm([&] { q1.knobs.body_tilt_rad = q1.knobs.attitude_offset_rad = 14.0 * kDegree; });
  EXPECT_TRUE(q1.is_armed);
}

TEST_F(Arming, IsForbiddenWhenAttitudesDisagree) {
  for (const double roll_rad : {12.0 * kDegree, -12.0 * kDegree}) {
    arm([&] { q1.knobs.attitude_offset_rad = roll_rad; });
    EXPECT_FALSE(q1.is_armed);
    EXPECT_TRUE(has("attitude disagrees"));
  }
}

TEST_F(Arming, IsForbiddenWhenYawsDisagree) {
  for (const double yaw_rad : {20.0 * kDegree, -20.0 * kDegree, kPi}) {
    arm([&] { q1.knobs.yaw_offset_rad = yaw_rad; });
    EXPECT_FALSE(q1.is_armed);
    EXPECT_TRUE(has("yaw disagrees"));
  }
  arm([&] { q1.knobs.yaw_offset_rad = 10.0 * kDegree; });
  EXPECT_TRUE(q1.is_armed);
}

TEST_F(Arming, IsForbiddenWhenTheEstimateDiffersFromMocap) {
  arm([&] { q1.knobs.estimate_offset_m = 0.4; });
  EXPECT_FALSE(q1.is_armed);
  EXPECT_TRUE(has("estimate off"));
}

// Regression: a condition that blocked arming for a moment deleted the `arm` order without a
// report.
TEST_F(Arming, KeepsTheCommandWhileABodyPasses) {
  arm();
  ASSERT_TRUE(q1.is_armed);
  const Eigen::Vector3d beside_m = q1.position_m + Eigen::Vector3d(0.52, 0.0, 0.0);
  bench.run(0.16, [&] { bench.room().target_positions_m = {beside_m}; });
  EXPECT_FALSE(q1.is_armed) << "the motors stop while the body is near";
  EXPECT_TRUE(has("arm pending"));
  EXPECT_TRUE(has("separation"));
  bench.run(1.5, [&] { bench.room().target_positions_m = {{3.5, 1.8, 0.0}}; });
  EXPECT_TRUE(q1.is_armed);
  EXPECT_FALSE(has("arm pending"));
}

TEST_F(Arming, DropsTheOrderAfterTheTimeLimit) {
  arm();
  const Eigen::Vector3d beside_m = q1.position_m + Eigen::Vector3d(0.52, 0.0, 0.0);
  bench.run(11.0, [&] { bench.room().target_positions_m = {beside_m}; });
  bench.run(1.0, [&] { bench.room().target_positions_m = {{3.5, 1.8, 0.0}}; });
  EXPECT_FALSE(q1.is_armed);
  EXPECT_TRUE(has("arm refused: separation"));
  bench.send_command(OperatorAction::kArm);
  bench.run(0.5, [&] { bench.room().target_positions_m = {{3.5, 1.8, 0.0}}; });
  EXPECT_TRUE(q1.is_armed);
  EXPECT_FALSE(has("arm refused: separation"));
}

// Only the operator can clear the condition "operator quiet", so the order is deleted.
TEST_F(Arming, DropsTheOrderWhenTheOperatorIsSilent) {
  arm();
  bench.run(2.0, [&] { bench.room().operator_silent = true; });
  EXPECT_FALSE(q1.is_armed);
  bench.run(3.0);
  EXPECT_FALSE(q1.is_armed);
  EXPECT_TRUE(has("arm refused: operator quiet"));
}

// Regression: `take-off` before the motors ran was dropped without a report.
TEST_F(Arming, KeepsTakeOffUntilTheMotorsRun) {
  bench.run(1.0);
  bench.send_command(OperatorAction::kArm);
  bench.tick();
  bench.send_command(OperatorAction::kTakeOff);
  bench.tick();
  bench.run(8.0);
  EXPECT_GT(q1.position_m.z(), 0.9);
}

TEST_F(Arming, RefusesTakeOffBeforeArm) {
  bench.run(1.0);
  bench.send_command(OperatorAction::kTakeOff);
  bench.run(1.0);
  EXPECT_TRUE(has("take-off refused: not armed"));
  bench.send_command(OperatorAction::kArm);
  bench.run(2.0);
  EXPECT_EQ(q1.out.state, FlightState::kIdle);
  EXPECT_FALSE(has("take-off refused: not armed"));
}

// Regression: a rover below the vehicle made it land immediately after the take-off.
TEST_F(Arming, TakeOffWaitsForNearBodies) {
  for (const double side : {1.0, -1.0}) {
    FlightBench room(5);
    Vehicle& vehicle = room.vehicle("Q1");
    room.run(1.0);
    room.send_command(OperatorAction::kArm);
    const Eigen::Vector3d from_m = vehicle.position_m + Eigen::Vector3d(0.65 * side, 0.0, 0.0);
    room.run(0.5, [&] { room.room().target_positions_m = {from_m}; });
    ASSERT_TRUE(vehicle.is_armed);
    room.send_command(OperatorAction::kTakeOff, "Q1");
    room.run(3.0, [&] { room.room().target_positions_m = {from_m}; });
    EXPECT_LT(vehicle.position_m.z(), 0.01);
    EXPECT_TRUE(FlightBench::has_reason(vehicle, "body nearby", room.now()));
    EXPECT_TRUE(vehicle.is_armed) << "a near body does not stop the motors";
    Eigen::Vector3d walker_m = from_m;
    room.run(8.0, [&] {
      walker_m.y() += 0.004;
      room.room().target_positions_m = {walker_m};
    });
    EXPECT_GT(vehicle.position_m.z(), 0.9);
    EXPECT_EQ(vehicle.out.state, FlightState::kHold);
    room.run(1.0, [&] { room.room().target_positions_m = {walker_m}; });
    EXPECT_TRUE(room.violations().empty());
  }
}

// Rounding of the cosine must not make the angle NaN, because NaN would forbid nothing.
TEST_F(Arming, AttitudeErrorIsFiniteDespiteRounding) {
  for (int degrees = -180; degrees <= 180; degrees += 6) {
    for (const double off_rad : {0.0, kPi}) {
      bench.run(0.05, [&] {
        q1.knobs.body_tilt_rad = degrees * kDegree;
        q1.knobs.attitude_offset_rad = degrees * kDegree + off_rad;
      });
      EXPECT_NEAR(q1.guard->inputs().attitude_error_rad, off_rad, 1e-6) << degrees;
      EXPECT_NEAR(q1.guard->inputs().body_tilt_rad, std::abs(degrees) * kDegree, 1e-6);
    }
  }
}

}  // namespace
}  // namespace vantage::test
