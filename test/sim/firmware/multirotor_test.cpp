#include "sim/firmware/multirotor.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "sim/firmware/firmware_sensors.hpp"
#include "test/sim/firmware/still_air.hpp"

namespace vantage::sim {
namespace {

using test::kGravityMps2;
using test::still_air;

/// Returns the throttle u at which the thrust of four motors equals the weight: e u² + (1 − e) u =
/// m g / (4 T_max).
double hover_throttle(const MultirotorParameters& p) {
  const double share = p.mass_kg * kGravityMps2 / (4.0 * p.motor_thrust_max_n);
  const double b = 1.0 - p.thrust_expo;
  return (-b + std::sqrt(b * b + 4.0 * p.thrust_expo * share)) / (2.0 * p.thrust_expo);
}

Throttles all(double u) { return {u, u, u, u}; }

/// Returns a body at a height of 10 m with its motors at hover.
Multirotor hovering(const MultirotorParameters& p) {
  Multirotor body(p, 1, {});
  const double u = hover_throttle(p);
  while (body.world_from_body().translation_m.z() < 10.0) {
    body.step(all(1.3 * u), 0.01);
  }
  for (int i = 0; i < 400; ++i) {
    body.step(all(u), 0.01);
  }
  return body;
}

TEST(Multirotor, RestsForAMinuteAndMeasuresGravity) {
  Multirotor body(still_air(), 1, {1.0, -2.0, 0.7});
  for (int i = 0; i < 6000; ++i) {
    body.step({}, 0.01);
  }
  const Pose3& pose = body.world_from_body();
  EXPECT_LT((pose.translation_m - Eigen::Vector3d(1.0, -2.0, 0.0)).norm(), 1e-4);
  EXPECT_NEAR(flatten(pose).yaw_rad, 0.7, 1e-6);
  EXPECT_LT((body.specific_force_body_mps2() - Eigen::Vector3d(0.0, 0.0, kGravityMps2)).norm(),
            1e-3);
  EXPECT_TRUE(body.is_on_ground());
}

TEST(Multirotor, ChangesItsClimbRateOnlyByDragAtHoverThrottle) {
  Multirotor body = hovering(still_air());
  const double before_mps = body.velocity_world_mps().z();
  body.step(all(hover_throttle(still_air())), 1.0);
  // Only drag changes the speed: v(t) = v e^(−d t).
  EXPECT_NEAR(body.velocity_world_mps().z(), before_mps * std::exp(-0.25), 2e-3);
  EXPECT_FALSE(body.is_on_ground());
}

TEST(Multirotor, FallsFreelyAndMeasuresDragOnly) {
  Multirotor body = hovering(still_air());
  for (int i = 0; i < 50; ++i) {
    body.step({}, 0.01);
  }
  const double v_mps = body.velocity_world_mps().norm();
  EXPECT_NEAR(body.specific_force_body_mps2().norm(), 0.25 * v_mps, 0.02 * v_mps);
  EXPECT_LT(body.velocity_world_mps().z(), -1.0);
}

// A turn to the left is the mirror image of a turn to the right.
TEST(Multirotor, TurnsWithMotorDifferences) {
  const MultirotorParameters p = still_air();
  const double u = hover_throttle(p);
  struct Case {
    Throttles more;
    Eigen::Vector3d turn;  ///< sign of the body rates
  };
  const double d = 0.05;
  const Case cases[] = {
      {{0.0, d, d, 0.0}, {1.0, 0.0, 0.0}},  // more thrust on the left: roll to the right, + about x
      {{d, 0.0, 0.0, d}, {-1.0, 0.0, 0.0}},  // more thrust on the right
      {{0.0, d, 0.0, d}, {0.0, 1.0, 0.0}},   // more thrust at the rear: nose down, + about y
      {{d, 0.0, d, 0.0}, {0.0, -1.0, 0.0}},  // more thrust at the front
      {{d, d, 0.0, 0.0}, {0.0, 0.0, -1.0}},  // left-turning propellers: body turns right
      {{0.0, 0.0, d, d}, {0.0, 0.0, 1.0}}};
  for (const Case& c : cases) {
    Multirotor body = hovering(p);
    Throttles throttles = all(u);
    for (std::size_t i = 0; i < kMotors; ++i) {
      throttles[i] += c.more[i];
    }
    body.step(throttles, 0.1);
    const Eigen::Vector3d rate = body.rate_body_radps();
    Eigen::Index axis = 0;
    EXPECT_GT(rate.cwiseAbs().maxCoeff(&axis), 0.01);
    EXPECT_GT(rate(axis) * c.turn(axis), 0.0) << rate.transpose() << " for " << c.turn.transpose();
  }
}

TEST(Multirotor, ReachesTheWindsSpeed) {
  MultirotorParameters p = still_air();
  p.wind_world_mps = {1.0, -0.5, 0.0};
  Multirotor body = hovering(p);
  for (int i = 0; i < 3000; ++i) {
    body.step(all(hover_throttle(p)), 0.01);
  }
  EXPECT_LT((body.velocity_world_mps() - p.wind_world_mps).head<2>().norm(), 0.01);
}

TEST(Multirotor, WindDoesNotMoveItOnGround) {
  MultirotorParameters p = still_air();
  p.wind_world_mps = {3.0, 0.0, 0.0};
  Multirotor body(p, 1, {});
  body.step({}, 20.0);
  EXPECT_LT(body.world_from_body().translation_m.norm(), 1e-3);
}

TEST(Multirotor, ComesToRestWhereItIsDropped) {
  Multirotor body(still_air(), 1, {});
  const double u = hover_throttle(still_air());
  body.step(all(1.3 * u), 0.6);
  EXPECT_GT(body.world_from_body().translation_m.z(), 0.1);
  body.step({}, 5.0);
  EXPECT_LT(body.velocity_world_mps().norm(), 1e-3);
  EXPECT_NEAR(body.world_from_body().translation_m.z(), 0.0, 1e-3);
}

TEST(Multirotor, DependsOnItsSeedOnly) {
  MultirotorParameters p;
  Multirotor a(p, 7, {});
  Multirotor b(p, 7, {});
  Multirotor c(p, 8, {});
  for (Multirotor* body : {&a, &b, &c}) {
    body->step(all(0.7), 1.0);
    body->step(all(0.6), 1.0);
  }
  EXPECT_EQ(a.world_from_body().translation_m, b.world_from_body().translation_m);
  EXPECT_NE(a.world_from_body().translation_m, c.world_from_body().translation_m);
}

TEST(Multirotor, HoversForItsEndurance) {
  MultirotorParameters p = still_air();
  p.battery_endurance_s = 60.0;
  Multirotor body = hovering(p);
  const double before = body.battery_share();
  body.step(all(hover_throttle(p)), 6.0);
  EXPECT_NEAR(before - body.battery_share(), 0.1, 2e-3);
  EXPECT_LT(body.battery_v(), p.battery_full_v);
}

TEST(SensorBoard, MeasuresGravityAndNorthInBodyFrdAxes) {
  const Multirotor body(still_air(), 1,
                        {0.0, 0.0, kPi / 2});  // faces the y axis of the world, which is west
  SensorBoard board(SensorNoise{0.0, 0.0, 0.0, 0.0, 0.0, 0.0}, 1);
  const FirmwareSensors sensed = board.sample(body, Duration{0});
  EXPECT_LT((sensed.specific_force_body_mps2 - Eigen::Vector3d(0.0, 0.0, -kGravityMps2)).norm(),
            1e-9);
  // North is to the right of the vehicle.
  EXPECT_GT(sensed.magnetic_field_body_gauss.y(), 0.15);
  EXPECT_NEAR(sensed.pressure_altitude_m, 10.0, 1e-9);
  EXPECT_NEAR(sensed.pressure_hpa, 1012.05, 0.05);
}

// Over 300 boards, the biases have the specified standard deviation. The bias of each board is
// constant.
TEST(SensorBoard, HasConstantBias) {
  const Multirotor body(still_air(), 1, {0.0, 0.0, 0.0});
  double turns2_radps2 = 0.0;
  double forces2_m2ps4 = 0.0;
  constexpr int kBoards = 300;
  for (int seed = 0; seed < kBoards; ++seed) {
    SensorBoard board(SensorNoise{0.0, 0.002, 0.0, 0.03, 0.0, 0.0},
                      static_cast<std::uint64_t>(seed));
    const FirmwareSensors sensed = board.sample(body, Duration{0});
    const FirmwareSensors later = board.sample(body, Duration{1'000'000});
    EXPECT_EQ(later.gyro_body_radps, sensed.gyro_body_radps);
    EXPECT_EQ(later.specific_force_body_mps2, sensed.specific_force_body_mps2);
    turns2_radps2 += sensed.gyro_body_radps.squaredNorm() / 3.0;
    forces2_m2ps4 +=
        (sensed.specific_force_body_mps2 - Eigen::Vector3d(0.0, 0.0, -kGravityMps2)).squaredNorm() /
        3.0;
  }
  EXPECT_NEAR(std::sqrt(turns2_radps2 / kBoards), 0.002, 0.0002);
  EXPECT_NEAR(std::sqrt(forces2_m2ps4 / kBoards), 0.03, 0.003);
}

}  // namespace
}  // namespace vantage::sim
