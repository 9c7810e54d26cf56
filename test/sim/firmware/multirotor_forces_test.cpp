// Compares forces and motion of a simulated quadrotor with closed forms.

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/axes.hpp"
#include "sim/firmware/firmware_sensors.hpp"
#include "sim/firmware/multirotor.hpp"
#include "test/sim/firmware/still_air.hpp"

namespace vantage::sim {
namespace {

using test::kGravityMps2;
using test::still_air;

double thrust_n(const MultirotorParameters& p, double u) {
  return p.motor_thrust_max_n * (p.thrust_expo * u * u + (1.0 - p.thrust_expo) * u);
}

Throttles all(double u) { return {u, u, u, u}; }

/// Returns the throttle at which the thrust of four motors equals the weight.
double hover(const MultirotorParameters& p) {
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double u = 0.5 * (low + high);
    (4.0 * thrust_n(p, u) < p.mass_kg * kGravityMps2 ? low : high) = u;
  }
  return low;
}

/// Returns a level body high above the ground, with motors that have settled at hover.
Multirotor in_the_air(const MultirotorParameters& p) {
  Multirotor body(p, 1, {});
  body.step(all(1.0), 2.0);
  body.step(all(hover(p)), 1.0);
  EXPECT_GT(body.world_from_body().translation_m.z(), 10.0);
  return body;
}

// All motors have the same thrust curve; throttles outside [0, 1] are clamped.
TEST(MultirotorForces, ThrustFollowsThrottleAndIsMeasured) {
  MultirotorParameters p = still_air();
  p.mass_kg = 1.3;
  for (const double u : {-0.5, 0.0, 0.2, 0.5, 0.9, 1.0, 1.7}) {
    Multirotor body = in_the_air(p);
    body.step(all(u), 0.6);
    const double felt_mps2 = body.specific_force_body_mps2().z();
    const double drag_mps2 = -p.drag_per_s * body.velocity_world_mps().z();
    EXPECT_NEAR(felt_mps2, 4.0 * thrust_n(p, std::clamp(u, 0.0, 1.0)) / p.mass_kg + drag_mps2,
                2e-3);
    EXPECT_EQ(body.specific_force_body_mps2().x(), 0.0);
  }
  for (std::size_t i = 0; i < kMotors; ++i) {
    Throttles one{};
    one[i] = 0.3;
    Multirotor body(p, 1, {});
    body.step(one, 1.0);  // the body stays on the ground; only the battery shows the load
    const double load = thrust_n(p, 0.3) / (p.mass_kg * kGravityMps2);
    EXPECT_NEAR(body.battery_a(), 0.3 + 12.0 * std::pow(load, 1.5), 1e-6) << i;
  }
}

TEST(MultirotorForces, MotorsFollowWithTheirLag) {
  const MultirotorParameters p = still_air();
  Multirotor body = in_the_air(p);
  body.step({}, 0.5);
  double past_s = 0.0;
  for (const double step_s : {0.01, 0.02, 0.04, 0.08}) {
    body.step(all(0.8), step_s);
    past_s += step_s;
    const double thrust_mps2 =
        body.specific_force_body_mps2().z() + p.drag_per_s * body.velocity_world_mps().z();
    const double share = 1.0 - std::exp(-past_s / p.motor_lag_s);
    EXPECT_NEAR(thrust_mps2, 4.0 * thrust_n(p, 0.8) / p.mass_kg * share, 5e-3) << past_s;
  }
}

// With more thrust on two motors, the rate about one axis follows J ω̇ = τ (1 − e^(−t/T)) − c ω,
// which has a closed form.
TEST(MultirotorForces, AngularAccelerationMatchesArmsAndInertia) {
  MultirotorParameters p = still_air();
  p.arm_x_m = 0.10;
  p.arm_y_m = 0.15;
  p.inertia_kgm2 = {0.006, 0.008, 0.010};
  p.torque_per_thrust_m = 0.03;
  struct Case {
    int first, second;
    int axis;
    double arm_m;  ///< m; lever arm of both motors together
  };
  const double u = hover(p);
  const double d = 0.03;
  for (const Case& c :
       {Case{1, 2, 0, 2.0 * 0.15}, Case{0, 3, 0, -2.0 * 0.15}, Case{1, 3, 1, 2.0 * 0.10},
        Case{0, 2, 1, -2.0 * 0.10}, Case{2, 3, 2, 2.0 * 0.03}, Case{0, 1, 2, -2.0 * 0.03}}) {
    Multirotor body = in_the_air(p);
    Throttles throttles = all(u);
    throttles[static_cast<std::size_t>(c.first)] += d;
    throttles[static_cast<std::size_t>(c.second)] += d;
    const double t = 0.15;
    body.step(throttles, t);
    const double torque_nm = c.arm_m * (thrust_n(p, u + d) - thrust_n(p, u));
    const double slow_s = p.inertia_kgm2(c.axis) / p.spin_drag_nms;
    const double lag_s = p.motor_lag_s;
    const double share =
        1.0 - (lag_s * std::exp(-t / lag_s) - slow_s * std::exp(-t / slow_s)) / (lag_s - slow_s);
    Eigen::Vector3d expected_radps = Eigen::Vector3d::Zero();
    expected_radps(c.axis) = torque_nm / p.spin_drag_nms * share;
    EXPECT_LT((body.rate_body_radps() - expected_radps).norm(), 0.01 * expected_radps.norm())
        << body.rate_body_radps().transpose() << " not " << expected_radps.transpose();
  }
}

TEST(MultirotorForces, RotationIsDamped) {
  MultirotorParameters p = still_air();
  p.spin_drag_nms = 0.01;
  Multirotor body = in_the_air(p);
  const double u = hover(p);
  body.step({u, u, u + 0.1, u + 0.1}, 0.2);
  body.step(all(u), 0.4);
  const double before_radps = body.rate_body_radps().z();
  EXPECT_GT(before_radps, 0.1);
  body.step(all(u), 0.7);
  EXPECT_NEAR(body.rate_body_radps().z(), before_radps * std::exp(-0.7 * 0.01 / 0.010),
              1e-3 * before_radps);
}

// A body that tumbles without torque keeps its angular momentum and energy in the world frame.
TEST(MultirotorForces, TumblesWithAConstantAngularMomentum) {
  MultirotorParameters p = still_air();
  p.inertia_kgm2 = {0.004, 0.007, 0.010};
  p.spin_drag_nms = 0.0;
  p.torque_per_thrust_m = 0.1;
  Multirotor body = in_the_air(p);
  const double u = hover(p);
  body.step({u, u + 0.03, u, u + 0.06}, 0.05);
  body.step({}, 0.5);
  const auto momentum = [&] {
    return Eigen::Vector3d(body.world_from_body().rotation *
                           p.inertia_kgm2.cwiseProduct(body.rate_body_radps()));
  };
  const auto energy = [&] {
    return body.rate_body_radps().dot(p.inertia_kgm2.cwiseProduct(body.rate_body_radps()));
  };
  const Eigen::Vector3d before = momentum();
  const double energy_before = energy();
  const Eigen::Vector3d rate_before = body.rate_body_radps();
  EXPECT_GT(rate_before.cwiseAbs().minCoeff(), 0.05);
  body.step({}, 0.5);
  EXPECT_GT((body.rate_body_radps() - rate_before).norm(), 0.05 * rate_before.norm());
  EXPECT_LT((momentum() - before).norm(), 0.01 * before.norm());
  EXPECT_NEAR(energy(), energy_before, 0.01 * energy_before);
}

// On the ground, thrust carries a part of the weight and thus reduces the compression of the feet.
// The body tilts on these springs.
TEST(MultirotorForces, RestsOnItsFeetLikeSprings) {
  MultirotorParameters p = still_air();
  p.foot_m = 0.10;
  p.torque_per_thrust_m = 0.2;
  const double k = p.foot_stiffness_npm;
  const double lift_n = thrust_n(p, 0.2);
  {
    Multirotor body(p, 1, {3.0, -4.0, -2.0});
    body.step(all(0.2), 1.0);
    const Eigen::Vector3d place_m = body.world_from_body().translation_m;
    EXPECT_NEAR(place_m.z(), 4.0 * lift_n / (4.0 * k), 1e-9);
    EXPECT_LT((place_m - Eigen::Vector3d(3.0, -4.0, place_m.z())).norm(), 1e-9);
    EXPECT_NEAR(flatten(body.world_from_body()).yaw_rad, -2.0, 1e-9);
    EXPECT_TRUE(body.is_on_ground());
  }
  struct Case {
    Throttles throttles;
    Eigen::Vector3d lean_rad;
  };
  const double u = 0.2;
  const double roll = 2.0 * p.arm_y_m * lift_n / (4.0 * k * 0.1 * 0.1);
  const double pitch = 2.0 * p.arm_x_m * lift_n / (4.0 * k * 0.1 * 0.1);
  const double yaw = 2.0 * p.torque_per_thrust_m * lift_n / (4.0 * k * 2.0 * 0.1 * 0.1);
  for (const Case& c :
       {Case{{0.0, u, u, 0.0}, {roll, 0.0, 0.0}}, Case{{u, 0.0, 0.0, u}, {-roll, 0.0, 0.0}},
        Case{{0.0, u, 0.0, u}, {0.0, pitch, 0.0}}, Case{{u, 0.0, u, 0.0}, {0.0, -pitch, 0.0}},
        Case{{0.0, 0.0, u, u}, {0.0, 0.0, yaw}}, Case{{u, u, 0.0, 0.0}, {0.0, 0.0, -yaw}}}) {
    Multirotor body(p, 1, {});
    body.step(c.throttles, 2.0);
    const Eigen::AngleAxisd turn(body.world_from_body().rotation);
    EXPECT_LT((turn.angle() * turn.axis() - c.lean_rad).norm(), 0.02 * c.lean_rad.norm())
        << (turn.angle() * turn.axis()).transpose() << " not " << c.lean_rad.transpose();
    EXPECT_LT(body.rate_body_radps().norm(), 1e-6);
    EXPECT_TRUE(body.is_on_ground());
  }
}

// A yaw torque larger than the friction of the feet makes the body slide around its vertical axis.
TEST(MultirotorForces, SlidesOnItsFeetAgainstFriction) {
  MultirotorParameters p = still_air();
  p.torque_per_thrust_m = 0.6;
  p.spin_drag_nms = 0.0;
  p.inertia_kgm2.z() = 0.2;
  const double thrust = thrust_n(p, 0.25);
  const double torque_nm = 2.0 * p.torque_per_thrust_m * thrust;
  const double held_nm =
      p.friction * (p.mass_kg * kGravityMps2 - 2.0 * thrust) * std::sqrt(2.0) * p.foot_m;
  for (const double side : {1.0, -1.0}) {
    const Throttles throttles =
        side > 0.0 ? Throttles{0.0, 0.0, 0.25, 0.25} : Throttles{0.25, 0.25, 0.0, 0.0};
    Multirotor held(p, 1, {});
    held.step(throttles, 0.5);
    MultirotorParameters smooth = p;
    smooth.friction = 0.3;
    Multirotor slides(smooth, 1, {});
    slides.step(throttles, 0.5);
    const double before_radps = slides.rate_body_radps().z();
    slides.step(throttles, 0.5);
    EXPECT_LT(torque_nm, held_nm);
    EXPECT_NEAR(held.rate_body_radps().z(), 0.0, 0.02);
    const double expected_radps2 = side * (torque_nm - held_nm * 0.3 / p.friction) / 0.2;
    EXPECT_NEAR((slides.rate_body_radps().z() - before_radps) / 0.5, expected_radps2,
                0.02 * std::abs(expected_radps2));
  }
}

// In a level hover the accelerometer measures only aerodynamic forces, so gusts are visible.
TEST(MultirotorForces, GustsHaveTheStatedStrengthAndTimeConstant) {
  MultirotorParameters p;
  p.gust_sigma_mps = 0.6;
  p.gust_memory_s = 0.02;
  p.wind_world_mps = {1.0, -2.0, 0.5};
  Multirotor body = in_the_air(p);
  const double hover_mps2 = 4.0 * thrust_n(p, hover(p)) / p.mass_kg;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  Eigen::Vector3d products = Eigen::Vector3d::Zero();
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  constexpr int kSteps = 6000;
  for (int n = 0; n < kSteps; ++n) {
    body.step(all(hover(p)), 0.02);
    Eigen::Vector3d force_mps2 = body.specific_force_body_mps2();
    force_mps2.z() -= hover_mps2;
    const Eigen::Vector3d gust =
        (force_mps2 / p.drag_per_s + body.velocity_world_mps() - p.wind_world_mps) / 0.6;
    mean += gust / kSteps;
    squares += gust.cwiseAbs2() / kSteps;
    products += gust.cwiseProduct(last) / kSteps;
    last = gust;
  }
  // The standard deviation of an estimated variance is about 2.5 %.
  const Eigen::Vector3d expected(1.0, 1.0, 1.0 / 9.0);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(mean(axis), 0.0, 0.1);
    EXPECT_NEAR(squares(axis) / expected(axis), 1.0, 0.1) << axis;
    EXPECT_NEAR(products(axis) / expected(axis), std::exp(-1.0), 0.08) << axis;
  }
}

TEST(MultirotorForces, LongStepEqualsSeveralShortSteps) {
  const MultirotorParameters p = still_air();
  Multirotor once(p, 1, {1.0, 2.0, 0.5});
  Multirotor often(p, 1, {1.0, 2.0, 0.5});
  const Throttles throttles{0.7, 0.71, 0.72, 0.69};
  for (int n = 0; n < 40; ++n) {
    once.step(throttles, 0.01);
    for (int i = 0; i < 20; ++i) {
      often.step(throttles, 0.0005);
    }
  }
  EXPECT_LT((once.world_from_body().translation_m - often.world_from_body().translation_m).norm(),
            1e-9);
  EXPECT_LT((once.rate_body_radps() - often.rate_body_radps()).norm(), 1e-9);
  EXPECT_GT(once.world_from_body().translation_m.z(), 0.1);
}

TEST(MultirotorForces, BatterySagsUnderLoadAndDischarges) {
  MultirotorParameters p = still_air();
  p.battery_endurance_s = 10.0;
  Multirotor body(p, 1, {});
  EXPECT_EQ(body.battery_share(), 1.0);
  EXPECT_EQ(body.battery_v(), 12.6);
  EXPECT_NEAR(body.battery_a(), 0.3, 1e-12);
  double used = 0.0;
  for (int n = 0; n < 200; ++n) {
    body.step(all(1.0), 0.01);
    const double load = 24.0 * (1.0 - std::exp(-(n + 1) * 0.01 / p.motor_lag_s)) / kGravityMps2;
    used += 0.01 * load / 10.0;
    EXPECT_NEAR(body.battery_share(), 1.0 - used, 1e-9);
    EXPECT_NEAR(body.battery_v(), 10.5 + 2.1 * body.battery_share() - 0.8 * load, 1e-9);
    EXPECT_NEAR(body.battery_a(), 0.3 + 12.0 * load * std::sqrt(load), 1e-6);
  }
  body.step(all(1.0), 10.0);
  EXPECT_EQ(body.battery_share(), 0.0);
}

// --- sensors

TEST(SensorBoard, ReportsMotionInAutopilotAxes) {
  MultirotorParameters p = still_air();
  p.wind_world_mps = {1.0, -0.5, 0.0};
  Multirotor body(p, 1, {1.0, 2.0, 0.7});
  const double u = hover(p);
  body.step({u + 0.15, u + 0.1, u + 0.12, u + 0.11}, 0.6);
  SensorBoard board(SensorNoise{0.0, 0.0, 0.0, 0.0, 0.0, 0.0}, 1);
  const FirmwareSensors sensed = board.sample(body, Duration{123'456});
  EXPECT_EQ(sensed.since_start, Duration{123'456});
  EXPECT_EQ(sensed.position_local_m, convert_axes(body.world_from_body().translation_m));
  EXPECT_EQ(sensed.velocity_local_mps, convert_axes(body.velocity_world_mps()));
  EXPECT_EQ(sensed.gyro_body_radps, convert_axes(body.rate_body_radps()));
  EXPECT_EQ(sensed.specific_force_body_mps2, convert_axes(body.specific_force_body_mps2()));
  EXPECT_GT(body.rate_body_radps().cwiseAbs().minCoeff(), 1e-3);
  const Eigen::Vector3d ahead_world = body.world_from_body().rotation * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d ahead_local = sensed.local_from_body * Eigen::Vector3d::UnitX();
  EXPECT_LT((ahead_local - convert_axes(ahead_world)).norm(), 1e-12);
  // In any attitude, the magnetic field in the local frame is that of the site.
  EXPECT_LT((sensed.local_from_body * sensed.magnetic_field_body_gauss -
             Eigen::Vector3d(0.205, -0.042, 0.470))
                .norm(),
            1e-9);
  const double height_m = body.world_from_body().translation_m.z();
  EXPECT_GT(height_m, 0.2);
  EXPECT_NEAR(sensed.pressure_altitude_m, 10.0 + height_m, 1e-9);
  // Standard atmosphere: near sea level the pressure decreases by 12.01 Pa per metre.
  EXPECT_NEAR(1013.25 - sensed.pressure_hpa, 0.1201 * (10.0 + height_m), 2e-3);
  EXPECT_EQ(sensed.battery_v, body.battery_v());
  EXPECT_EQ(sensed.battery_a, body.battery_a());
  EXPECT_EQ(sensed.battery_share, body.battery_share());
  EXPECT_EQ(sensed.temperature_c, 20.0);
}

// The noise is white and independent for each sensor and axis, with the specified standard
// deviation.
TEST(SensorBoard, NoiseIsIndependentPerSensorAndAxis) {
  const Multirotor body(still_air(), 1, {});
  SensorBoard silent(SensorNoise{0.0, 0.0, 0.0, 0.0, 0.0, 0.0}, 1);
  const FirmwareSensors truth = silent.sample(body, Duration{0});
  SensorBoard board(SensorNoise{0.01, 0.0, 0.05, 0.0, 0.002, 0.3}, 7);
  constexpr int kSamples = 8000;
  Eigen::Matrix<double, 10, 10> moments = Eigen::Matrix<double, 10, 10>::Zero();
  for (int n = 0; n < kSamples; ++n) {
    const FirmwareSensors sensed = board.sample(body, Duration{0});
    Eigen::Matrix<double, 10, 1> e;
    e << (sensed.gyro_body_radps - truth.gyro_body_radps) / 0.01,
        (sensed.specific_force_body_mps2 - truth.specific_force_body_mps2) / 0.05,
        (sensed.magnetic_field_body_gauss - truth.magnetic_field_body_gauss) / 0.002,
        (sensed.pressure_altitude_m - truth.pressure_altitude_m) / 0.3;
    moments += e * e.transpose() / kSamples;
  }
  // The standard deviation of an estimated variance is 1.6 %, of a correlation 1.1 %.
  EXPECT_LT((moments - Eigen::Matrix<double, 10, 10>::Identity()).cwiseAbs().maxCoeff(), 0.08);
}

}  // namespace
}  // namespace vantage::sim
