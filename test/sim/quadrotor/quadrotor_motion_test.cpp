// Compares the response of a simulated quadrotor without wind with closed forms. This reveals a
// wrong factor or a one-sided error, which the tolerances of a complete flight would hide.

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "sim/quadrotor/quadrotor.hpp"

namespace vantage::sim {
namespace {

using models::FlightState;
using models::OperatorAction;
using Complex = std::complex<double>;

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr Duration kStep{5'000};
constexpr double kDtS = 0.005;

QuadrotorParameters still_air() {
  QuadrotorParameters out;
  out.wind_sigma_mps2 = 0.0;
  return out;
}

scenario::RobotSpec robot_at(const Pose2& start) {
  scenario::RobotSpec spec;
  spec.name = "Q1";
  spec.start = start;
  spec.height_m = 1.5;
  spec.limits.speed_max_mps = 1.0;
  return spec;
}

models::RobotPlan plan_of(const models::Trajectory& trajectory, std::int64_t round = 1) {
  models::RobotPlan plan;
  plan.robot = "Q1";
  plan.round = round;
  plan.trajectory = trajectory;
  return plan;
}

struct Flight {
  explicit Flight(const Pose2& start, const QuadrotorParameters& parameters = still_air(),
                  double tolerance_m = 0.2)
      : vehicle(robot_at(start), tolerance_m, 4, kStart, parameters) {}
  void follow(const models::Trajectory& trajectory) {
    ASSERT_EQ(vehicle.offer(plan_of(trajectory), now), PlanVerdict::kAccepted);
  }
  void step() {
    vehicle.step(now, kDtS);
    now += kStep;
  }
  void run(double seconds) {
    for (const Time end = now + from_seconds(seconds); now < end;) {
      step();
    }
  }
  [[nodiscard]] Complex place() const {
    return {vehicle.position_world_m().x(), vehicle.position_world_m().y()};
  }
  Quadrotor vehicle;
  Time now = kStart;
};

Complex at_angle(double angle_rad) { return std::polar(1.0, angle_rad); }

// On a circle all vectors rotate at ω. The vehicle step v ← v + α (v_cmd − v), p ← p + dt (v +
// v′)/2 then becomes an equation of complex numbers.
TEST(QuadrotorMotion, FollowsACircleByItsEquations) {
  const QuadrotorParameters p = still_air();
  for (const double omega : {1.5, -1.5}) {
    Flight flight({1.0, 2.0, 0.4});
    const double speed = 0.6;
    flight.follow({kStart, {1.0, 2.0, 0.4}, 1.5, {{{speed, omega}, 100.0, 0.0}}});
    const Complex i(0.0, 1.0);
    const double radius = speed / omega;
    const Complex centre = Complex(1.0, 2.0) + radius * i * at_angle(0.4);
    const Complex turn = at_angle(omega * kDtS);
    const double alpha = 1.0 - std::exp(-kDtS / p.velocity_lag_s);
    const double k = p.position_gain_per_s;
    const double w = p.corner_window_s;
    // The command for a reference r e^(iωt) contains its velocity and acceleration, averaged over ±
    // w.
    const Complex mean = (at_angle(omega * w) - at_angle(-omega * w)) / (2.0 * w);
    const Complex wish = mean + p.velocity_lag_s * i * omega * mean + k;
    const Complex half = 0.5 * kDtS * (turn + 1.0);
    const Complex gain = wish / ((turn - 1.0 + alpha) / alpha * (turn - 1.0) / half + k);
    flight.run(20.0);
    for (int n = 0; n < 300; ++n) {
      flight.step();
      const Complex arm = -radius * i * at_angle(0.4 + omega * to_seconds(flight.now - kStart));
      EXPECT_NEAR(std::abs(flight.place() - centre - gain * arm), 0.0, 1e-6) << omega;
    }
    EXPECT_NEAR(flight.vehicle.yaw_rate_radps(), omega, 1e-6);
    const double heading_rad = 0.4 + omega * to_seconds(flight.now - kStart);
    EXPECT_NEAR(wrap_to_pi(flight.vehicle.yaw_rad() - heading_rad), 0.0, 1e-6);
  }
}

// Rotating and mirroring the world does not change the flight.
TEST(QuadrotorMotion, IsInvariantToRotationAndReflection) {
  const auto fly = [](double turn_rad, double side) {
    const auto see = [&](const Pose2& pose) {
      const Complex place = Complex(pose.x_m, side * pose.y_m) * at_angle(turn_rad);
      return Pose2{place.real(), place.imag(), wrap_to_pi(side * pose.yaw_rad + turn_rad)};
    };
    Flight flight(see({1.0, 2.0, 0.5}));
    flight.follow({kStart + Duration{300'000},
                   see({1.05, 2.1, 0.4}),
                   1.6,
                   {{{1.0, side * 1.0}, 1.0, 0.0}, {{0.5, side * -2.0}, 1.0, 0.0}}});
    flight.run(1.8);
    flight.vehicle.command(OperatorAction::kHold, flight.now);
    flight.run(2.0);
    const Complex place = flight.place() * at_angle(-turn_rad);
    return Eigen::Vector4d(place.real(), side * place.imag(),
                           wrap_to_pi(side * (flight.vehicle.yaw_rad() - turn_rad)),
                           flight.vehicle.position_world_m().z());
  };
  const Eigen::Vector4d expected = fly(0.0, 1.0);
  EXPECT_GT((expected.head<2>() - Eigen::Vector2d(1.0, 2.0)).norm(), 0.8);
  for (const double turn_rad : {0.0, 1.0, 2.4, -1.5, -3.0}) {
    for (const double side : {1.0, -1.0}) {
      EXPECT_LT((fly(turn_rad, side) - expected).cwiseAbs().maxCoeff(), 1e-9)
          << turn_rad << ' ' << side;
    }
  }
}

// The reference jumps by δ, and the averaged velocity v_s moves the vehicle by this distance. With
// lag T, gain k and error e, the vehicle obeys ẍ T = v_s + k e − ẋ. For any averaging window,
// ∫ e = 0 and ∫ t e = −T δ/k follow. (Steps of the controller increase the lag by half a step.)
TEST(QuadrotorMotion, RecoversFromPlanJumpAsPredicted) {
  const QuadrotorParameters p = still_air();
  for (const double side : {1.0, -1.0}) {
    const double jump_m = side * 0.1;
    const double jump_rad = side * 0.2;
    Flight flight({1.0, 2.0, 0.0});
    const Time jump = kStart + Duration{500'000};
    flight.follow({jump, {1.0, 2.0 + jump_m, jump_rad}, 1.5, {}});
    double error_ms = 0.0;
    double error_ms2 = 0.0;
    double turn_rads = 0.0;
    double turn_rads2 = 0.0;
    for (int n = 0; n < 2000; ++n) {
      const double t = to_seconds(flight.now - jump);
      const bool has_jumped = flight.now >= jump;
      const double e_m =
          (has_jumped ? jump_m : 0.0) - (flight.vehicle.position_world_m().y() - 2.0);
      const double e_rad = (has_jumped ? jump_rad : 0.0) - flight.vehicle.yaw_rad();
      error_ms += e_m * kDtS;
      error_ms2 += t * e_m * kDtS;
      turn_rads += e_rad * kDtS;
      turn_rads2 += t * e_rad * kDtS;
      flight.step();
    }
    EXPECT_NEAR(error_ms, 0.0, 0.006 * std::abs(jump_m));
    EXPECT_NEAR(turn_rads, 0.0, 0.006 * std::abs(jump_rad));
    EXPECT_NEAR(error_ms2, -(p.velocity_lag_s + 0.5 * kDtS) * jump_m / p.position_gain_per_s,
                0.02 * p.velocity_lag_s * std::abs(jump_m) / p.position_gain_per_s);
    EXPECT_NEAR(turn_rads2, -(p.yaw_rate_lag_s + 0.5 * kDtS) * jump_rad / p.yaw_gain_per_s,
                0.03 * p.yaw_rate_lag_s * std::abs(jump_rad) / p.yaw_gain_per_s);
  }
}

// Without feedback, a jump of speed and yaw rate at a corner becomes a ramp from w before the
// corner to w after it, where w is half the averaging window. The lag is compensated, except for
// half a step.
TEST(QuadrotorMotion, StartsARampBeforeACorner) {
  QuadrotorParameters p = still_air();
  p.position_gain_per_s = 0.0;
  p.yaw_gain_per_s = 0.0;
  const Time corner = kStart + Duration{1'000'000};
  for (const double side : {1.0, -1.0}) {
    Flight straight({0.0, 0.0, 0.0}, p);
    straight.follow({corner, {0.0, 0.0, 0.0}, 1.5, {{{side * 0.8, 0.0}, 10.0, 0.0}}});
    Flight turning({0.0, 0.0, 0.0}, p);
    turning.follow({corner, {0.0, 0.0, 0.0}, 1.5, {{{0.0, side * 1.2}, 10.0, 0.0}}});
    for (int n = 0; n < 400; ++n) {
      straight.step();
      turning.step();
      const double w = p.corner_window_s;
      const double share = std::clamp((to_seconds(turning.now - corner) + w) / (2.0 * w), 0.0, 1.0);
      const double late = 0.6 * kDtS / (2.0 * w);  // half a step, as a share of the ramp
      EXPECT_NEAR(turning.vehicle.yaw_rate_radps(), side * 1.2 * share, 1.2 * late);
      EXPECT_NEAR(straight.vehicle.velocity_world_mps().x(), side * 0.8 * share, 0.8 * late);
    }
    EXPECT_NEAR(turning.vehicle.yaw_rate_radps(), side * 1.2, 1e-6);
  }
}

TEST(QuadrotorMotion, KeepsItsClimbAndDescentLimits) {
  const QuadrotorParameters p = still_air();
  for (const double side : {1.0, -1.0}) {
    Flight near({0.0, 0.0, 0.0});
    near.follow({kStart, {0.0, 0.0, 0.0}, 1.5 + side * 0.2, {}});
    double error_ms = 0.0;
    for (int n = 0; n < 3000; ++n) {
      error_ms += (1.5 + side * 0.2 - near.vehicle.position_world_m().z()) * kDtS;
      near.step();
    }
    // z̈ T = k e − ż without saturation gives k ∫ e = δ.
    EXPECT_NEAR(error_ms, side * 0.2 / p.height_gain_per_s, 0.001);
    EXPECT_NEAR(near.vehicle.position_world_m().z(), 1.5 + side * 0.2, 1e-9);
    Flight far({0.0, 0.0, 0.0}, p, 1.0);
    far.follow({kStart, {0.0, 0.0, 0.0}, 1.5 + side * 1.2, {}});
    double fastest_mps = 0.0;
    for (int n = 0; n < 400; ++n) {
      far.step();
      fastest_mps = std::max(fastest_mps, side * far.vehicle.velocity_world_mps().z());
    }
    EXPECT_NEAR(fastest_mps, p.climb_max_mps, 1e-4);
  }
}

// If the command exceeds the limits by far, the speed rises to the limit plus its reserve, at the
// maximum acceleration.
TEST(QuadrotorMotion, SaturatesAtItsLimits) {
  QuadrotorParameters p = still_air();
  p.acceleration_max_mps2 = 4.0;
  p.yaw_acceleration_max_radps2 = 20.0;
  for (const double side : {1.0, -1.0}) {
    Flight flight({0.0, 0.0, 0.0}, p, 1e9);
    flight.follow(
        {kStart + Duration{200'000}, {0.0, 0.0, 0.0}, 1.5, {{{side * 40.0, 0.0}, 9.0, 0.0}}});
    Flight turning({0.0, 0.0, 0.0}, p, 1e9);
    turning.follow(
        {kStart + Duration{200'000}, {0.0, 0.0, 0.0}, 1.5, {{{0.0, side * 9.0}, 9.0, 0.0}}});
    double fastest_radps = 0.0;
    double steepest_radps2 = 0.0;
    double steepest_mps2 = 0.0;
    for (int n = 0; n < 400; ++n) {
      const double before_radps = turning.vehicle.yaw_rate_radps();
      const double before_mps = flight.vehicle.velocity_world_mps().x();
      turning.step();
      flight.step();
      const double now_radps = turning.vehicle.yaw_rate_radps();
      const double now_mps = flight.vehicle.velocity_world_mps().x();
      fastest_radps = std::max(fastest_radps, side * now_radps);
      steepest_radps2 = std::max(steepest_radps2, side * (now_radps - before_radps) / kDtS);
      steepest_mps2 = std::max(steepest_mps2, side * (now_mps - before_mps) / kDtS);
    }
    EXPECT_NEAR(side * flight.vehicle.velocity_world_mps().x(), 1.3, 1e-3);
    EXPECT_NEAR(fastest_radps, 1.3 * robot_at({}).limits.yaw_rate_max_radps, 0.02);
    EXPECT_NEAR(steepest_radps2, 20.0, 1e-9);
    EXPECT_NEAR(steepest_mps2, 4.0, 1e-9);
  }
}

// The vehicle responds only to wind, so each change of its velocity equals the wind.
TEST(QuadrotorMotion, WindIsCorrelatedAndTruncatedAtThreeSigma) {
  QuadrotorParameters p;
  p.velocity_lag_s = 1e12;
  p.wind_sigma_mps2 = 0.2;
  p.wind_memory_s = 0.01;
  Flight flight({0.0, 0.0, 0.0}, p);
  constexpr int kSteps = 40'000;
  Eigen::Vector2d last = Eigen::Vector2d::Zero();
  Eigen::Vector2d most = Eigen::Vector2d::Zero();
  Eigen::Vector2d least = Eigen::Vector2d::Zero();
  Eigen::Vector2d squares = Eigen::Vector2d::Zero();
  Eigen::Vector2d products = Eigen::Vector2d::Zero();
  double across = 0.0;
  for (int n = 0; n < kSteps; ++n) {
    const Eigen::Vector2d before_mps = flight.vehicle.velocity_world_mps().head<2>();
    flight.step();
    const Eigen::Vector2d wind =
        (flight.vehicle.velocity_world_mps().head<2>() - before_mps) / (kDtS * 0.2);
    most = most.cwiseMax(wind);
    least = least.cwiseMin(wind);
    squares += wind.cwiseAbs2() / kSteps;
    products += wind.cwiseProduct(last) / kSteps;
    across += wind.x() * wind.y() / kSteps;
    last = wind;
  }
  // The samples are correlated over three steps. About 15,000 are independent, so the standard
  // deviation of a variance is 1.2 %.
  for (int axis = 0; axis < 2; ++axis) {
    EXPECT_NEAR(squares(axis), 1.0, 0.06);
    EXPECT_NEAR(products(axis), std::exp(-0.5), 0.06);
    EXPECT_NEAR(most(axis), 3.0, 1e-6);
    EXPECT_NEAR(least(axis), -3.0, 1e-6);
  }
  EXPECT_NEAR(across, 0.0, 0.05);
}

TEST(QuadrotorMotion, FallsBallisticallyAndStaysWhereItLands) {
  Flight flight({1.0, 2.0, 0.5});
  flight.follow({kStart, {1.0, 2.0, 0.5}, 1.5, {{{0.9, 1.0}, 60.0, 0.0}}});
  flight.run(2.0);
  const Complex from = flight.place();
  const Eigen::Vector3d thrown_mps = flight.vehicle.velocity_world_mps();
  flight.vehicle.command(OperatorAction::kEmergencyStop, flight.now);
  flight.run(0.5);
  const Complex expected = from + 0.5 * Complex(thrown_mps.x(), thrown_mps.y());
  EXPECT_LT(std::abs(flight.place() - expected), 1e-9);
  EXPECT_NEAR(flight.vehicle.velocity_world_mps().z(), -9.81 * 0.5, 1e-9);
  EXPECT_NEAR(flight.vehicle.position_world_m().z(), 1.5 - 0.5 * 9.81 * 0.25, 1e-9);
  flight.run(0.5);
  EXPECT_EQ(flight.vehicle.velocity_world_mps(), Eigen::Vector3d::Zero());
  EXPECT_EQ(flight.vehicle.yaw_rate_radps(), 0.0);
  const Eigen::Vector3d lies_m = flight.vehicle.position_world_m();
  EXPECT_EQ(lies_m.z(), 0.0);
  // After it is armed again, the vehicle waits, then takes off to its height above its position on
  // the ground.
  flight.vehicle.command(OperatorAction::kArm, flight.now);
  EXPECT_EQ(flight.vehicle.state(), FlightState::kIdle);
  flight.run(0.5);
  EXPECT_EQ(flight.vehicle.position_world_m(), lies_m);
  flight.vehicle.command(OperatorAction::kTakeOff, flight.now);
  flight.run(8.0);
  EXPECT_LT(
      (flight.vehicle.position_world_m() - Eigen::Vector3d(lies_m.x(), lies_m.y(), 1.5)).norm(),
      1e-4);
}

TEST(QuadrotorMotion, LandsWhereItStopsAndStaysThere) {
  Flight flight({1.0, 2.0, 0.0});
  flight.follow({kStart, {1.0, 2.0, 0.0}, 1.5, {{{0.8, 0.5}, 60.0, 0.0}}});
  flight.run(2.0);
  const Complex from = flight.place();
  const Eigen::Vector3d from_mps = flight.vehicle.velocity_world_mps();
  const double heading_rad = flight.vehicle.yaw_rad();
  flight.vehicle.command(OperatorAction::kLand, flight.now);
  flight.run(1.0);
  EXPECT_NEAR(flight.vehicle.velocity_world_mps().z(), -0.5, 1e-2);
  flight.run(4.0);
  ASSERT_EQ(flight.vehicle.state(), FlightState::kIdle);
  const double distance_m = from_mps.squaredNorm() / (2.0 * 2.0);
  const Complex stop = from + distance_m * Complex(from_mps.x(), from_mps.y()) / from_mps.norm();
  EXPECT_LT(std::abs(flight.place() - stop), 1e-3);
  EXPECT_NEAR(flight.vehicle.yaw_rad(), heading_rad, 1e-3);
  EXPECT_EQ(flight.vehicle.position_world_m().z(), 0.0);
  EXPECT_EQ(flight.vehicle.velocity_world_mps(), Eigen::Vector3d::Zero());
  flight.run(0.5);
  EXPECT_EQ(flight.vehicle.yaw_rate_radps(), 0.0);
}

// A second hold command changes nothing.
TEST(QuadrotorMotion, IgnoresRepeatedCommand) {
  const auto rests_at = [](bool is_told_twice) {
    Flight flight({0.0, 0.0, 0.0});
    flight.follow({kStart, {0.0, 0.0, 0.0}, 1.5, {{{1.0, 0.0}, 60.0, 0.0}}});
    flight.run(2.0);
    flight.vehicle.command(OperatorAction::kHold, flight.now);
    flight.run(0.25);
    if (is_told_twice) {
      flight.vehicle.command(OperatorAction::kHold, flight.now);
      flight.vehicle.command(OperatorAction::kFollow, flight.now);
    }
    flight.run(2.0);
    return flight.vehicle.position_world_m();
  };
  EXPECT_EQ(rests_at(true), rests_at(false));
}

TEST(Quadrotor, AcceptsPlansUpToTheirLimits) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const models::PlanSegment good{{1.0, 0.5}, 0.5, 0.0};
  const auto verdict_on = [&](const models::PlanSegment& segment, bool is_first, double y_m = 0.0) {
    Flight flight({0.0, 0.0, 0.0});
    models::Trajectory plan{kStart, {0.0, y_m, 0.0}, 1.5, {good, good}};
    plan.segments[is_first ? 0 : 1] = segment;
    return flight.vehicle.offer(plan_of(plan), kStart);
  };
  for (const bool is_first : {true, false}) {
    EXPECT_EQ(verdict_on({{1.0, 0.5}, 0.0, 0.0}, is_first), PlanVerdict::kAccepted);
    EXPECT_EQ(verdict_on({{1.0, 0.5}, 3600.0, 0.0}, is_first), PlanVerdict::kAccepted);
    EXPECT_EQ(verdict_on({{-1.0, -0.5}, 1.0, 2.0}, is_first), PlanVerdict::kAccepted);
    EXPECT_EQ(verdict_on({{1.0, 0.5}, 3600.1, 0.0}, is_first), PlanVerdict::kNotFinite);
    EXPECT_EQ(verdict_on({{1.0, 0.5}, -1e-9, 0.0}, is_first), PlanVerdict::kNotFinite);
    EXPECT_EQ(verdict_on({{1.0, 0.5}, 0.5, -1e-9}, is_first), PlanVerdict::kNotFinite);
    EXPECT_EQ(verdict_on({{1.0, 0.5}, 0.5, infinity}, is_first), PlanVerdict::kNotFinite);
    EXPECT_EQ(verdict_on({{infinity, 0.5}, 0.5, 0.0}, is_first), PlanVerdict::kNotFinite);
    EXPECT_EQ(verdict_on({{1.0, nan}, 0.5, 0.0}, is_first), PlanVerdict::kNotFinite);
  }
  EXPECT_EQ(verdict_on(good, true, nan), PlanVerdict::kNotFinite);
  for (const double side : {1.0, -1.0}) {
    EXPECT_EQ(verdict_on(good, true, side * 0.39), PlanVerdict::kAccepted);
    EXPECT_EQ(verdict_on(good, true, side * 0.41), PlanVerdict::kDiscontinuous);
  }
  Flight flight({0.0, 0.0, 0.0});
  // The three-dimensional distance counts: each component alone would be accepted.
  EXPECT_EQ(flight.vehicle.offer(plan_of({kStart, {0.25, 0.25, 0.0}, 1.75, {}}), kStart),
            PlanVerdict::kDiscontinuous);
  EXPECT_EQ(flight.vehicle.offer(plan_of({kStart, {0.2, 0.2, 0.0}, 1.7, {}}), kStart),
            PlanVerdict::kAccepted);
  EXPECT_EQ(flight.vehicle.offer(plan_of({kStart, {0.0, 0.0, 0.0}, 1.5, {}}, 2), kStart),
            PlanVerdict::kAccepted)
      << "a plan of equal age is not older";
}

TEST(Quadrotor, RequiresAFiniteStartAboveTheGround) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto is_refused = [](const Pose2& start, double height_m) {
    scenario::RobotSpec spec = robot_at(start);
    spec.height_m = height_m;
    try {
      const Quadrotor vehicle(spec, 0.2, 1, kStart);
    } catch (const UsageError& error) {
      return std::string(error.what()) == "robot Q1: start must be finite and above the ground";
    }
    return false;
  };
  EXPECT_FALSE(is_refused({1.0, 2.0, 3.0}, 0.1));
  EXPECT_TRUE(is_refused({1.0, 2.0, 3.0}, 0.0));
  EXPECT_TRUE(is_refused({1.0, 2.0, 3.0}, -1.0));
  EXPECT_TRUE(is_refused({nan, 2.0, 3.0}, 1.0));
  EXPECT_TRUE(is_refused({1.0, nan, 3.0}, 1.0));
  EXPECT_TRUE(is_refused({1.0, 2.0, nan}, 1.0));
}

TEST(Quadrotor, ReportsStateSetPointAndBattery) {
  Flight flight({1.0, 2.0, 0.5});
  Quadrotor& vehicle = flight.vehicle;
  EXPECT_EQ(vehicle.name(), "Q1");
  EXPECT_EQ(vehicle.radius_m(), robot_at({}).limits.radius_m);
  EXPECT_EQ(vehicle.status(kStart - Duration{1}).battery_share, 1.0);
  EXPECT_EQ(vehicle.status(kStart + from_seconds(300.0)).battery_share, 0.75);
  EXPECT_EQ(vehicle.status(kStart + from_seconds(1'200.0)).battery_share, 0.0);
  EXPECT_EQ(vehicle.status(kStart + from_seconds(2'000.0)).battery_share, 0.0);
  models::VehicleStatus status = vehicle.status(kStart);
  EXPECT_EQ(status.robot, "Q1");
  EXPECT_EQ(status.stamp.time, kStart);
  EXPECT_EQ(status.state, FlightState::kFollow);
  EXPECT_EQ(status.setpoint, (Pose2{1.0, 2.0, 0.5}));
  EXPECT_EQ(status.setpoint_height_m, 1.5);
  EXPECT_EQ(status.reasons, std::vector<std::string>{"no plan"});
  flight.follow({kStart, {1.0, 2.0, 0.5}, 1.6, {}});
  status = vehicle.status(kStart);
  EXPECT_EQ(status.setpoint_height_m, 1.6);
  EXPECT_TRUE(status.reasons.empty());
  vehicle.command(OperatorAction::kHold, kStart);
  status = vehicle.status(kStart);
  EXPECT_EQ(status.setpoint_height_m, 1.5) << "holds at its current height";
  EXPECT_EQ(status.reasons, std::vector<std::string>{"operator"});
  vehicle.command(OperatorAction::kLand, kStart);
  EXPECT_EQ(vehicle.status(kStart).setpoint_height_m, 0.0);
  EXPECT_EQ(vehicle.status(kStart).reasons, std::vector<std::string>{"operator"});
  vehicle.command(OperatorAction::kEmergencyStop, kStart);
  EXPECT_EQ(vehicle.status(kStart).setpoint_height_m, 0.0);
  EXPECT_EQ(vehicle.status(kStart).reasons, std::vector<std::string>{"operator"});
  flight.run(1.0);
  vehicle.command(OperatorAction::kArm, flight.now);
  EXPECT_EQ(vehicle.status(flight.now).state, FlightState::kIdle);
  EXPECT_EQ(vehicle.status(flight.now).setpoint_height_m, 0.0);
  EXPECT_TRUE(vehicle.status(flight.now).reasons.empty());
}

// Drag converts wind into acceleration: a quarter of the wind speed per second.
TEST(Quadrotor, HasTheScenariosWindOrDefaultGusts) {
  const QuadrotorParameters windy = parameters_in(scenario::WindSpec{4.0, -2.0, 0.8});
  EXPECT_EQ(windy.wind_mean_mps2, Eigen::Vector2d(1.0, -0.5));
  EXPECT_EQ(windy.wind_sigma_mps2, 0.2);
  EXPECT_EQ(parameters_in(std::nullopt).wind_mean_mps2, Eigen::Vector2d::Zero());
  EXPECT_EQ(parameters_in(std::nullopt).wind_sigma_mps2, 0.15);
}

}  // namespace
}  // namespace vantage::sim
