#include "sim/quadrotor/quadrotor.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "sim/quadrotor/lag.hpp"

namespace vantage::sim {
namespace {

using models::FlightState;
using models::OperatorAction;

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr Duration kStep{5'000};
constexpr double kDtS = 0.005;
using Scalar = Eigen::Matrix<double, 1, 1>;

scenario::RobotSpec robot_spec(double speed_max_mps) {
  scenario::RobotSpec spec;
  spec.name = "Q1";
  spec.start = {1.0, 2.0, 0.5};
  spec.height_m = 1.5;
  spec.limits.speed_max_mps = speed_max_mps;
  return spec;
}

models::RobotPlan plan_from(const models::Trajectory& trajectory, std::int64_t round) {
  models::RobotPlan plan;
  plan.robot = "Q1";
  plan.round = round;
  plan.trajectory = trajectory;
  plan.stamp.time = trajectory.start_time;
  return plan;
}

struct Errors {
  std::vector<double> position_m;
  std::vector<double> yaw_rad;
  double quantile(std::vector<double> v, double q) const {
    std::sort(v.begin(), v.end());
    return v[static_cast<std::size_t>(q * static_cast<double>(v.size() - 1))];
  }
};

// Flies rounds of six random 0.5 s primitives. Each plan starts at the planned end point of the
// previous round and is published 50 ms ahead. The tracking error is measured against the plan at
// all times.
Errors fly_random_rounds(const std::vector<models::UnicycleControl>& primitives,
                         double speed_max_mps, std::uint64_t seed, int rounds) {
  Quadrotor vehicle(robot_spec(speed_max_mps), 0.2, seed, kStart);
  std::mt19937_64 rng(seed);
  std::uniform_int_distribution<std::size_t> draw(0, primitives.size() - 1);
  Errors errors;
  models::Trajectory current{kStart, robot_spec(speed_max_mps).start, 1.5, {}};
  Time now = kStart;
  for (int round = 0; round < rounds; ++round) {
    const Time begin = kStart + std::chrono::seconds(3 * (round + 1));
    models::Trajectory next{begin, models::at(current, begin).world_from_body, 1.5, {}};
    for (int k = 0; k < 12; ++k) {
      next.segments.push_back({primitives[draw(rng)], 0.5, 0.0});
    }
    for (const auto& stop : models::brake(next.segments.back().control.speed_mps, 2.0)) {
      next.segments.push_back(stop);
    }
    bool offered = false;
    while (now < begin) {
      if (!offered && now >= begin - Duration{50'000}) {
        EXPECT_EQ(vehicle.offer(plan_from(next, round), now), PlanVerdict::kAccepted);
        offered = true;
      }
      vehicle.step(now, kDtS);
      now += kStep;
      const Pose2 planned = models::at(now >= begin ? next : current, now).world_from_body;
      errors.position_m.push_back(
          (planned.position_m() - vehicle.position_world_m().head<2>()).norm());
      errors.yaw_rad.push_back(std::abs(wrap_to_pi(planned.yaw_rad - vehicle.yaw_rad())));
      EXPECT_NEAR(vehicle.position_world_m().z(), 1.5, 1e-9);
    }
    current = next;
  }
  return errors;
}

TEST(FirstOrderLag, EqualsTheClosedForm) {
  Scalar x(0.0);
  for (int i = 1; i <= 200; ++i) {
    x = first_order_lag<1>(x, Scalar(2.0), 0.15, 1e9, kDtS);
    EXPECT_NEAR(x(0), 2.0 * (1.0 - std::exp(-i * kDtS / 0.15)), 1e-12);
  }
}

TEST(FirstOrderLag, KeepsItsRateLimit) {
  Scalar x(0.0);
  for (int i = 1; i <= 20; ++i) {
    x = first_order_lag<1>(x, Scalar(100.0), 0.15, 10.0, kDtS);
    EXPECT_NEAR(x(0), 10.0 * i * kDtS, 1e-12);
  }
}

TEST(Quadrotor, HoversAtItsStartWithoutAPlan) {
  Quadrotor vehicle(robot_spec(1.0), 0.2, 3, kStart);
  Time now = kStart;
  for (int i = 0; i < 12000; ++i, now += kStep) {
    vehicle.step(now, kDtS);
    EXPECT_LT((vehicle.position_world_m() - Eigen::Vector3d(1.0, 2.0, 1.5)).norm(), 0.05);
  }
  EXPECT_NEAR(vehicle.yaw_rad(), 0.5, 1e-9);
  EXPECT_EQ(vehicle.status(now).plan_round, -1);
  EXPECT_GT((vehicle.position_world_m() - Eigen::Vector3d(1.0, 2.0, 1.5)).norm(), 1e-6)
      << "the wind has an effect";
}

// In hover x″ + c x′ + ω² x = w, with c = 1/T, ω² = k/T and a wind w with decay rate β. The
// position is white noise through a third-order filter, so its variance has a closed form (James,
// Nichols, Phillips 1947).
TEST(Quadrotor, HoverVarianceMatchesWindModel) {
  const QuadrotorParameters p;
  const double c = 1.0 / p.velocity_lag_s;
  const double omega2 = p.position_gain_per_s / p.velocity_lag_s;
  const double beta = 1.0 / p.wind_memory_s;
  const double expected_m2 = p.wind_sigma_mps2 * p.wind_sigma_mps2 * (c + beta) /
                             (omega2 * c * (omega2 + c * beta + beta * beta));
  Quadrotor vehicle(robot_spec(1.0), 0.2, 3, kStart);
  Time now = kStart;
  double squares_m2 = 0.0;
  constexpr int kSteps = 120'000;  // 10 min
  for (int i = 0; i < kSteps; ++i, now += kStep) {
    vehicle.step(now, kDtS);
    squares_m2 += (vehicle.position_world_m().head<2>() - Eigen::Vector2d(1.0, 2.0)).squaredNorm();
  }
  EXPECT_NEAR(squares_m2 / (2.0 * kSteps), expected_m2, 0.3 * expected_m2);
}

TEST(Quadrotor, TracksTheLabPlansWithinFifteenCentimetres) {
  const Errors errors = fly_random_rounds(models::lab_primitives(), 1.0, 5, 100);
  const double worst = *std::max_element(errors.position_m.begin(), errors.position_m.end());
  EXPECT_LT(worst, 0.15);
  std::cout << "1 m/s: median " << errors.quantile(errors.position_m, 0.5) << " m, 99 % "
            << errors.quantile(errors.position_m, 0.99) << " m, worst " << worst
            << " m; yaw median " << errors.quantile(errors.yaw_rad, 0.5) << " rad, 99 % "
            << errors.quantile(errors.yaw_rad, 0.99) << " rad\n";
}

TEST(Quadrotor, TracksTheFieldPlansWithinHalfAMetre) {
  const Errors errors = fly_random_rounds(models::standard_primitives(), 3.0, 6, 100);
  const double worst = *std::max_element(errors.position_m.begin(), errors.position_m.end());
  EXPECT_LT(worst, 0.5);
  std::cout << "3 m/s: median " << errors.quantile(errors.position_m, 0.5) << " m, 99 % "
            << errors.quantile(errors.position_m, 0.99) << " m, worst " << worst
            << " m; yaw median " << errors.quantile(errors.yaw_rad, 0.5) << " rad, 99 % "
            << errors.quantile(errors.yaw_rad, 0.99) << " rad\n";
}

// The plan's heading is slightly left or right of the vehicle's heading. The vehicle makes the
// short turn, also across ±π.
TEST(Quadrotor, MakesTheShorterTurnAcrossPi) {
  for (const double side : {1.0, -1.0}) {
    for (const double start_rad : {kPi - 0.1, 0.4}) {
      scenario::RobotSpec spec = robot_spec(1.0);
      spec.start.yaw_rad = side * start_rad;
      Quadrotor vehicle(spec, 0.2, 1, kStart);
      models::Trajectory plan{kStart + Duration{500'000}, spec.start, 1.5, {}};
      plan.start.yaw_rad = wrap_to_pi(side * (start_rad + 0.3));
      ASSERT_EQ(vehicle.offer(plan_from(plan, 1), kStart), PlanVerdict::kAccepted);
      double last_rad = vehicle.yaw_rad();
      double turned_rad = 0.0;
      for (Time now = kStart; now < kStart + Duration{4'000'000}; now += kStep) {
        vehicle.step(now, kDtS);
        const double step_rad = side * wrap_to_pi(vehicle.yaw_rad() - last_rad);
        EXPECT_GT(step_rad, -0.005) << "turned in the wrong direction";
        turned_rad += step_rad;
        last_rad = vehicle.yaw_rad();
      }
      EXPECT_NEAR(turned_rad, 0.3, 0.02) << side << " from " << start_rad;
    }
  }
}

TEST(Quadrotor, KeepsItsSpeedLimitsForAnyPlan) {
  const QuadrotorParameters p;
  Quadrotor vehicle(robot_spec(1.0), 1e9, 9, kStart);
  models::Trajectory wild{kStart, {0.0, 0.0, 0.0}, 1.5, {{{40.0, 30.0}, 3.0, 0.0}}};
  ASSERT_EQ(vehicle.offer(plan_from(wild, 0), kStart), PlanVerdict::kAccepted);
  const double wind_mps = 3.0 * p.wind_sigma_mps2 * std::sqrt(2.0) * p.velocity_lag_s;
  Eigen::Vector3d old_mps = vehicle.velocity_world_mps();
  double old_radps = 0.0;
  Time now = kStart;
  for (int i = 0; i < 2000; ++i, now += kStep) {
    vehicle.step(now, kDtS);
    EXPECT_LE(vehicle.velocity_world_mps().norm(), p.command_reserve * 1.0 + 1.1 * wind_mps);
    EXPECT_LE((vehicle.velocity_world_mps() - old_mps).norm() / kDtS,
              p.acceleration_max_mps2 + 3.0 * p.wind_sigma_mps2 * std::sqrt(2.0) + 1e-9);
    EXPECT_LE(std::abs(vehicle.yaw_rate_radps()), p.command_reserve * 3.0 + 1e-12);
    EXPECT_LE(std::abs(vehicle.yaw_rate_radps() - old_radps) / kDtS,
              p.yaw_acceleration_max_radps2 + 1e-9);
    old_mps = vehicle.velocity_world_mps();
    old_radps = vehicle.yaw_rate_radps();
  }
}

TEST(Quadrotor, RefusesInvalidPlan) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Quadrotor vehicle(robot_spec(1.0), 0.2, 1, kStart);
  const models::Trajectory good{
      kStart + Duration{1'000'000}, {1.0, 2.0, 0.5}, 1.5, {{{1.0, 1.0}, 0.5, 0.0}}};
  for (int broken = 0; broken < 8; ++broken) {
    models::Trajectory bad = good;
    double* const fields[] = {&bad.start.x_m,
                              &bad.start.yaw_rad,
                              &bad.height_m,
                              &bad.segments[0].control.speed_mps,
                              &bad.segments[0].control.yaw_rate_radps,
                              &bad.segments[0].duration_s,
                              &bad.segments[0].brake_mps2};
    if (broken < 7) {
      *fields[broken] = nan;
    } else {
      bad.segments[0].duration_s = -1.0;
    }
    EXPECT_EQ(vehicle.offer(plan_from(bad, 0), kStart), PlanVerdict::kNotFinite) << broken;
  }
  models::Trajectory far = good;
  far.start.x_m += 0.41;
  EXPECT_EQ(vehicle.offer(plan_from(far, 0), kStart), PlanVerdict::kDiscontinuous);
  models::Trajectory high = good;
  high.height_m += 0.41;
  EXPECT_EQ(vehicle.offer(plan_from(high, 0), kStart), PlanVerdict::kDiscontinuous);
  EXPECT_EQ(vehicle.offer(plan_from(good, 0), kStart), PlanVerdict::kAccepted);
  models::Trajectory old = good;
  old.start_time -= Duration{1};
  EXPECT_EQ(vehicle.offer(plan_from(old, 0), kStart), PlanVerdict::kStale);
}

TEST(Quadrotor, SwitchesAtTheStartOfANewPlan) {
  Quadrotor vehicle(robot_spec(1.0), 0.2, 1, kStart);
  const Time begin = kStart + Duration{1'000'000};
  const models::Trajectory plan{begin, {1.0, 2.0, 0.5}, 1.5, {{{1.0, 0.0}, 2.0, 0.0}}};
  ASSERT_EQ(vehicle.offer(plan_from(plan, 7), kStart), PlanVerdict::kAccepted);
  EXPECT_EQ(vehicle.status(begin - Duration{1}).plan_round, -1);
  EXPECT_EQ(vehicle.status(begin).plan_round, 7);
  // A later plan must start at the end of the pending one, not at the vehicle's position.
  models::Trajectory next{begin + Duration{1'000'000}, {1.0, 2.0, 0.5}, 1.5, {}};
  EXPECT_EQ(vehicle.offer(plan_from(next, 8), kStart), PlanVerdict::kDiscontinuous);
  next.start = models::at(plan, next.start_time).world_from_body;
  EXPECT_EQ(vehicle.offer(plan_from(next, 8), kStart), PlanVerdict::kAccepted);
  EXPECT_EQ(vehicle.status(begin).plan_round, 7);
  EXPECT_EQ(vehicle.status(next.start_time).plan_round, 8);
}

TEST(Quadrotor, AcceptsALatePlanOnlyNearItsPosition) {
  Quadrotor vehicle(robot_spec(1.0), 0.2, 1, kStart);
  Time now = kStart;
  for (int i = 0; i < 400; ++i, now += kStep) {
    vehicle.step(now, kDtS);
  }
  // The plan started 1 s ago, so its current point is 1 m ahead.
  models::Trajectory plan{
      now - Duration{1'000'000}, {1.0, 2.0, 0.5}, 1.5, {{{1.0, 0.0}, 2.0, 0.0}}};
  EXPECT_EQ(vehicle.offer(plan_from(plan, 0), now), PlanVerdict::kDiscontinuous);
  plan.start_time = now - Duration{300'000};
  EXPECT_EQ(vehicle.offer(plan_from(plan, 0), now), PlanVerdict::kAccepted);
}

struct InFlight {
  Quadrotor vehicle{robot_spec(1.0), 0.2, 4, kStart};
  Time now = kStart;

  InFlight() {
    const models::Trajectory plan{kStart, {1.0, 2.0, 0.5}, 1.5, {{{1.0, 0.0}, 60.0, 0.0}}};
    EXPECT_EQ(vehicle.offer(plan_from(plan, 0), now), PlanVerdict::kAccepted);
    run(3.0);
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / kDtS); ++i, now += kStep) {
      vehicle.step(now, kDtS);
    }
  }
};

TEST(Quadrotor, BrakesToAHoldAndStaysThere) {
  InFlight flight;
  const Eigen::Vector3d at_hold = flight.vehicle.position_world_m();
  flight.vehicle.command(OperatorAction::kHold, flight.now);
  flight.run(3.0);
  // The braking distance v²/2b is 0.25 m at 1 m/s and 2 m/s².
  EXPECT_NEAR((flight.vehicle.position_world_m() - at_hold).norm(), 0.25, 0.06);
  EXPECT_LT(flight.vehicle.velocity_world_mps().norm(), 0.1);
  const Eigen::Vector3d at_rest = flight.vehicle.position_world_m();
  flight.run(20.0);
  EXPECT_LT((flight.vehicle.position_world_m() - at_rest).norm(), 0.08);
  EXPECT_EQ(flight.vehicle.state(), FlightState::kHold);
  const models::Trajectory plan{flight.now, {at_rest.x(), at_rest.y(), 0.5}, 1.5, {}};
  EXPECT_EQ(flight.vehicle.offer(plan_from(plan, 1), flight.now), PlanVerdict::kNotFollowing);
  flight.vehicle.command(OperatorAction::kFollow, flight.now);
  EXPECT_EQ(flight.vehicle.offer(plan_from(plan, 1), flight.now), PlanVerdict::kAccepted);
}

TEST(Quadrotor, LandsAndTakesOffAgain) {
  InFlight flight;
  flight.vehicle.command(OperatorAction::kLand, flight.now);
  flight.run(2.0);
  EXPECT_EQ(flight.vehicle.state(), FlightState::kLand);
  EXPECT_NEAR(flight.vehicle.position_world_m().z(), 1.5 - 0.5 * 2.0, 0.1);
  flight.run(2.0);
  EXPECT_EQ(flight.vehicle.state(), FlightState::kIdle);
  EXPECT_EQ(flight.vehicle.position_world_m().z(), 0.0);
  flight.vehicle.command(OperatorAction::kTakeOff, flight.now);
  flight.run(6.0);
  EXPECT_EQ(flight.vehicle.state(), FlightState::kHold);
  EXPECT_NEAR(flight.vehicle.position_world_m().z(), 1.5, 0.01);
}

TEST(Quadrotor, FallsFreelyWhenKilled) {
  InFlight flight;
  flight.vehicle.command(OperatorAction::kEmergencyStop, flight.now);
  flight.run(0.3);
  EXPECT_NEAR(flight.vehicle.position_world_m().z(), 1.5 - 0.5 * 9.81 * 0.3 * 0.3, 1e-6);
  flight.run(1.0);
  EXPECT_EQ(flight.vehicle.position_world_m().z(), 0.0);
  EXPECT_EQ(flight.vehicle.velocity_world_mps().norm(), 0.0);
  for (const auto action : {OperatorAction::kFollow, OperatorAction::kTakeOff,
                            OperatorAction::kHold, OperatorAction::kLand}) {
    flight.vehicle.command(action, flight.now);
    EXPECT_EQ(flight.vehicle.state(), FlightState::kKilled);
  }
}

TEST(AfterCommand, LowersSeverityOnlyWhereTheTableAllows) {
  const std::vector<FlightState> states{FlightState::kIdle, FlightState::kFollow,
                                        FlightState::kHold, FlightState::kLand,
                                        FlightState::kKilled};
  for (const FlightState state : states) {
    EXPECT_EQ(after_command(state, OperatorAction::kHeartbeat, false), state);
    EXPECT_EQ(after_command(state, OperatorAction::kEmergencyStop, false), FlightState::kKilled);
    for (const auto action : {OperatorAction::kHold, OperatorAction::kLand}) {
      EXPECT_GE(static_cast<int>(after_command(state, action, false)), static_cast<int>(state));
    }
  }
  EXPECT_EQ(after_command(FlightState::kLand, OperatorAction::kFollow, false), FlightState::kLand);
  EXPECT_EQ(after_command(FlightState::kKilled, OperatorAction::kArm, false), FlightState::kKilled);
  EXPECT_EQ(after_command(FlightState::kKilled, OperatorAction::kArm, true), FlightState::kIdle);
  EXPECT_EQ(after_command(FlightState::kFollow, OperatorAction::kTakeOff, false),
            FlightState::kFollow);
}

}  // namespace
}  // namespace vantage::sim
