#include "drivers/safety/surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "drivers/safety/plan_check.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/support/bisect.hpp"
#include "test/support/random.hpp"

namespace vantage::drivers {
namespace {

SafetyLimits bench_limits() { return limits_for(test::FlightBench::scenario(), "Q1"); }

double clearance_m(const Eigen::Vector3d& p_m, const SafetyLimits& limits) {
  const Eigen::Vector2d level_m = p_m.head<2>();
  return std::min(fence_distance_m(limits.fence, level_m),
                  obstacle_distance_m(limits.fence, level_m)) -
         limits.vehicle.radius_m;
}

TEST(ClearSpot, IsANearbyClearSpotOrEmptyIfTheHoverIsClear) {
  const SafetyLimits limits = bench_limits();
  test::Random random(11);
  int moved = 0;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d hover_m(random.uniform(-4.0, 4.0), random.uniform(-2.2, 2.2), 1.0);
    const double before_m = clearance_m(hover_m, limits);
    const auto spot_m = clear_spot(hover_m, {}, limits);
    if (before_m >= limits.hover_clearance_m) {
      EXPECT_FALSE(spot_m.has_value());
    } else if (before_m > -0.25) {  // m; a move of 0.4 m is enough; the limit is 0.6 m
      ASSERT_TRUE(spot_m.has_value()) << hover_m.transpose();
      EXPECT_GE(clearance_m(*spot_m, limits), limits.hover_clearance_m + 0.05);
      EXPECT_LE((*spot_m - hover_m).norm(), 0.6 + 1e-9);
      EXPECT_EQ(spot_m->z(), hover_m.z());
      ++moved;
    }
  }
  EXPECT_GT(moved, 500);
}

TEST(ClearSpot, KeepsItsDistanceFromBodies) {
  const SafetyLimits limits = bench_limits();
  test::Random random(12);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d hover_m(random.uniform(-4.0, 4.0), random.uniform(-2.2, 2.2), 1.0);
    std::vector<OtherBody> others(2);
    for (OtherBody& other : others) {
      other.position_world_m =
          hover_m + Eigen::Vector3d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), 0.0);
    }
    if (const auto spot_m = clear_spot(hover_m, others, limits)) {
      for (const OtherBody& other : others) {
        const double before_m = (hover_m - other.position_world_m).norm();
        const double after_m = (*spot_m - other.position_world_m).norm();
        EXPECT_GE(after_m, std::min(before_m, limits.separation_hold_m));
      }
    }
  }
}

// A vehicle that is commanded to hold at the edge of an obstacle moves away a little. It continues
// when commanded to follow. The parameter is the age of mocap frames at a tick, ms.
class Hovering : public ::testing::TestWithParam<int> {};

TEST_P(Hovering, MovesAwayFromAnObstacle) {
  test::FlightBench bench(1);
  bench.fly_up(6.4);
  test::Vehicle& vehicle = bench.vehicle("Q3");
  const SafetyLimits limits = limits_for(test::FlightBench::scenario(), "Q3");
  while (!(vehicle.velocity_mps.x() > 0.9 && std::abs(vehicle.position_m.x() + 0.25) < 0.02)) {
    ASSERT_LT(bench.time_s(), 20.0);
    bench.tick();
  }
  vehicle.position_m.y() = 1.07;  // the obstacle ends at 0.8 m, the radius is 0.25 m
  bench.tick();
  const auto tick = [&bench] {
    bench.room().mocap_age_ms = GetParam();
    bench.tick();
  };
  bench.room().command = models::OperatorAction::kHold;
  tick();
  ASSERT_EQ(vehicle.out.state, models::FlightState::kHold);
  for (const double until_s = bench.time_s() + 5.0; bench.time_s() < until_s;) {
    tick();
    EXPECT_GT(clearance_m(vehicle.position_m, limits), 0.0);
  }
  EXPECT_EQ(vehicle.out.state, models::FlightState::kHold);
  EXPECT_GT(clearance_m(vehicle.position_m, limits), limits.hover_clearance_m);
  bench.room().command = models::OperatorAction::kFollow;
  for (const double until_s = bench.time_s() + 5.0; bench.time_s() < until_s;) {
    tick();
  }
  EXPECT_EQ(vehicle.out.state, models::FlightState::kFollow);
}

INSTANTIATE_TEST_SUITE_P(FlightGuard, Hovering, ::testing::Values(0, 8));

// A pose jump within the gate must not be interpreted as a velocity of metres per second, because
// that would start a braking manoeuvre.
TEST(FlightGuard, ContinuesAfterASmallPoseJump) {
  test::FlightBench bench(1);
  bench.fly_up(6.4);
  test::Vehicle& vehicle = bench.vehicle("Q3");
  const double lane_y_m = vehicle.position_m.y();
  vehicle.position_m.y() -= 0.2;
  for (const double until_s = bench.time_s() + 10.0; bench.time_s() < until_s;) {
    bench.tick();
    EXPECT_LT(std::abs(vehicle.position_m.y() - lane_y_m), 0.25);
  }
  EXPECT_EQ(vehicle.out.state, models::FlightState::kFollow);
}

// Regression: a vehicle that climbed late collided with one that flew above it.
TEST(IsClimbBlocked, CountsRobotsAboveNowOrSoon) {
  const SafetyLimits limits;
  const Eigen::Vector3d here_m(0.0, 0.0, 0.3);
  const auto is_taken = [&](double x_m, double z_m, double vx_mps, int robot = 1) {
    OtherBody body;
    body.position_world_m = {x_m, 0.0, z_m};
    body.velocity_world_mps = {vx_mps, 0.0, 0.0};
    body.robot = robot;
    return is_climb_blocked(here_m, 2.0, {&body, 1}, limits);
  };
  for (const double side : {1.0, -1.0}) {
    EXPECT_TRUE(is_taken(0.5 * side, 1.0, 0.0));
    EXPECT_FALSE(is_taken(1.5 * side, 1.0, 0.0));
    EXPECT_TRUE(is_taken(1.5 * side, 1.0, -0.5 * side)) << "the robot approaches";
    EXPECT_FALSE(is_taken(1.5 * side, 1.0, 0.5 * side)) << "the robot moves away";
  }
  EXPECT_FALSE(is_taken(0.5, 0.2, 0.0)) << "below the vehicle";
  EXPECT_FALSE(is_taken(0.5, 2.0 + limits.separation_hold_m + 0.01, 0.0)) << "above the climb";
  EXPECT_TRUE(is_taken(0.5, 2.0 + limits.separation_hold_m - 0.01, 0.0));
  EXPECT_FALSE(is_taken(0.5, 1.0, 0.0, -1)) << "not a robot";
}

OtherBody random_body(test::Random& random) {
  OtherBody body;
  body.position_world_m = {random.uniform(-3.0, 3.0), random.uniform(-2.0, 2.0),
                           random.uniform(0.0, 2.5)};
  body.velocity_world_mps = random.vector<3>(-1.0, 1.0);
  body.planned_world_mps =
      random.coin() ? body.velocity_world_mps : Eigen::Vector3d(random.vector<3>(-1.0, 1.0));
  body.age_s = random.coin() ? 0.0 : random.uniform(0.0, 2.0);
  body.has_priority = random.coin();
  body.robot = random.coin() ? 1 : -1;
  return body;
}

/// Returns the smallest distance between two vehicles that brake straight after the reaction time,
/// computed by integration in small steps.
double stepped_closest_m(Eigen::Vector3d p_m, Eigen::Vector3d v_mps, Eigen::Vector3d q_m,
                         Eigen::Vector3d w_mps, const SafetyLimits& limits) {
  constexpr double kStepS = 2e-4;
  double least_m = (p_m - q_m).norm();
  for (double t_s = 0.0; t_s < 4.0; t_s += kStepS) {
    for (auto [place_m, speed_mps] : {std::pair{&p_m, &v_mps}, std::pair{&q_m, &w_mps}}) {
      *place_m += kStepS * *speed_mps;
      if (t_s > limits.reaction_s) {
        const double slower_mps =
            std::max(0.0, speed_mps->norm() - kStepS * limits.vehicle.brake_mps2);
        *speed_mps = speed_mps->norm() > 0.0 ? Eigen::Vector3d(slower_mps * speed_mps->normalized())
                                             : Eigen::Vector3d::Zero();
      }
    }
    least_m = std::min(least_m, (p_m - q_m).norm());
  }
  return least_m;
}

TEST(ComputeSurroundings, FindsTheLeastSeparationOfBrakingVehicles) {
  const SafetyLimits limits = bench_limits();
  test::Random random(41);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d here_m(0.0, -1.0, 1.0);
    const Eigen::Vector3d v_mps = random.vector<3>(-1.0, 1.0);
    OtherBody body;
    body.robot = 0;
    body.position_world_m = here_m + random.vector<3>(-0.8, 0.8);
    body.velocity_world_mps = random.vector<3>(-1.5, 1.5);
    body.planned_world_mps =
        random.coin() ? body.velocity_world_mps : Eigen::Vector3d(random.vector<3>(-1.5, 1.5));
    const BrakingPath way =
        BrakingPath::straight(here_m, v_mps, 0.0, limits.vehicle.brake_mps2, limits.reaction_s);
    const auto closest_m = [&](const Eigen::Vector3d& w_mps) {
      return stepped_closest_m(here_m, v_mps, body.position_world_m, w_mps, limits);
    };
    const Surroundings seen = compute_surroundings(here_m, way, {&body, 1}, limits);
    EXPECT_DOUBLE_EQ(seen.separation_now_m, (here_m - body.position_world_m).norm());
    EXPECT_NEAR(seen.separation_stop_m,
                std::min(closest_m(body.velocity_world_mps), closest_m(body.planned_world_mps)),
                0.01);
  }
}

// A body that was unseen for longer than the hold limit may be anywhere within a radius that grows
// up to a limit.
TEST(ComputeSurroundings, AddsAnUncertaintyToAnUnseenBody) {
  const SafetyLimits limits = bench_limits();
  const Eigen::Vector3d here_m(1.0, -1.0, 1.0);
  const BrakingPath way =
      BrakingPath::straight(here_m, Eigen::Vector3d::Zero(), 0.0, limits.vehicle.brake_mps2, 0.2);
  OtherBody body;
  body.robot = 0;
  body.position_world_m = here_m + Eigen::Vector3d(0.0, 2.0, 0.0);
  for (double age_s = 0.0; age_s < 2.0; age_s += 0.01) {
    body.age_s = age_s;
    const Surroundings seen = compute_surroundings(here_m, way, {&body, 1}, limits);
    const double grown_m = std::clamp(0.5 * (age_s - 0.1), 0.0, 0.5);
    EXPECT_NEAR(seen.separation_now_m, 2.0 - grown_m, 1e-12) << age_s;
    EXPECT_NEAR(seen.separation_stop_m, 2.0 - grown_m, 1e-12) << age_s;
  }
}

TEST(ComputeSurroundings, ReportsTheNearestBodyAndItsPriority) {
  const SafetyLimits limits = bench_limits();
  const Eigen::Vector3d here_m(1.0, -1.0, 1.0);
  const BrakingPath way =
      BrakingPath::straight(here_m, Eigen::Vector3d::Zero(), 0.0, limits.vehicle.brake_mps2, 0.2);
  for (std::size_t near = 0; near < 3; ++near) {
    std::vector<OtherBody> others(3);
    for (std::size_t i = 0; i < others.size(); ++i) {
      const double apart_m = i == near ? 0.8 : 1.5;
      others[i].position_world_m = here_m + Eigen::Vector3d(0.0, apart_m, 0.0);
      others[i].has_priority = i == near;
      others[i].robot = static_cast<int>(i);
    }
    Surroundings seen = compute_surroundings(here_m, way, others, limits);
    EXPECT_NEAR(seen.separation_now_m, 0.8, 1e-12);
    EXPECT_NEAR(seen.separation_stop_m, 0.8, 1e-12);
    EXPECT_TRUE(seen.yields);
    for (OtherBody& other : others) {
      other.has_priority = !other.has_priority;
    }
    seen = compute_surroundings(here_m, way, others, limits);
    EXPECT_FALSE(seen.yields);
  }
}

TEST(ComputeSurroundings, FindsTheLeastDistancesToFenceAndObstaclesWhileBraking) {
  const SafetyLimits limits = bench_limits();
  test::Random random(42);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d here_m(random.uniform(-3.8, 3.8), random.uniform(-2.0, 2.0),
                                 random.uniform(0.2, 2.9));
    const BrakingPath way = BrakingPath::straight(here_m, random.vector<3>(-1.0, 1.0), 0.0,
                                                  limits.vehicle.brake_mps2, limits.reaction_s);
    double fence_m = 1e9;
    double obstacle_m = 1e9;
    for (int k = 0; k <= 1000; ++k) {
      const Eigen::Vector3d p_m = way.at(way.duration_s() * k / 1000.0).position_world_m;
      const Eigen::Vector2d level_m = p_m.head<2>();
      fence_m = std::min({fence_m, fence_distance_m(limits.fence, level_m) - 0.25,
                          limits.fence.ceiling_m - p_m.z()});
      obstacle_m = std::min(obstacle_m, obstacle_distance_m(limits.fence, level_m) - 0.25);
    }
    const Surroundings seen = compute_surroundings(here_m, way, {}, limits);
    EXPECT_NEAR(seen.fence_stop_m, fence_m, 1e-9);
    EXPECT_NEAR(seen.obstacle_stop_m, obstacle_m, 0.02);  // the path is sampled every 7 cm
    const double centre_m = fence_distance_m(limits.fence, here_m.head<2>());
    const double below_m = limits.fence.ceiling_m - here_m.z();
    EXPECT_NEAR(seen.fence_centre_m, std::min(centre_m, below_m), 1e-12);
    EXPECT_NEAR(seen.fence_now_m, std::min(centre_m - 0.25, below_m), 1e-12);
  }
}

/// The room and all bodies in transformed coordinates. `of(x, y)` maps positions; without its shift
/// of the origin it also maps velocities.
template <class Place>
struct TransformedRoom {
  Place of;

  [[nodiscard]] Eigen::Vector3d place(const Eigen::Vector3d& p_m) const {
    const Eigen::Vector2d level_m = of(p_m.x(), p_m.y());
    return {level_m.x(), level_m.y(), p_m.z()};
  }
  [[nodiscard]] Eigen::Vector3d way(const Eigen::Vector3d& v) const {
    return place(v) - place(Eigen::Vector3d::Zero());
  }
  [[nodiscard]] OtherBody body(OtherBody body) const {
    body.position_world_m = place(body.position_world_m);
    body.velocity_world_mps = way(body.velocity_world_mps);
    body.planned_world_mps = way(body.planned_world_mps);
    return body;
  }
  [[nodiscard]] SafetyLimits limits(SafetyLimits limits) const {
    const auto box = [this](models::Rectangle& rectangle) {
      const Eigen::Vector2d a_m = of(rectangle.min_m.x(), rectangle.min_m.y());
      const Eigen::Vector2d b_m = of(rectangle.max_m.x(), rectangle.max_m.y());
      rectangle = {a_m.cwiseMin(b_m), a_m.cwiseMax(b_m)};
    };
    box(limits.fence.bounds);
    for (models::Obstacle& obstacle : limits.fence.obstacles) {
      box(obstacle.footprint);
    }
    return limits;
  }
};

template <class Place>
void expect_the_same(const Place& of, test::Random& random) {
  const TransformedRoom<Place> seen{of};
  const SafetyLimits limits = bench_limits();
  const SafetyLimits other_limits = seen.limits(limits);
  const Eigen::Vector3d here_m(random.uniform(-3.5, 3.5), random.uniform(-1.8, 1.8),
                               random.uniform(0.2, 2.0));
  const Eigen::Vector3d there_m = here_m + random.vector<3>(-1.0, 1.0);
  const Eigen::Vector3d v_mps = random.vector<3>(-1.0, 1.0);
  std::vector<OtherBody> bodies;
  std::vector<OtherBody> others;
  for (int i = 0; i < 3; ++i) {
    bodies.push_back(random_body(random));
    others.insert(others.begin(), seen.body(bodies.back()));  // also in reverse order
  }
  const auto look = [&](const Eigen::Vector3d& p_m, const Eigen::Vector3d& speed_mps,
                        const std::vector<OtherBody>& around, const SafetyLimits& lim) {
    const BrakingPath way =
        BrakingPath::straight(p_m, speed_mps, 0.0, lim.vehicle.brake_mps2, lim.reaction_s);
    return compute_surroundings(p_m, way, around, lim);
  };
  const Surroundings a = look(here_m, v_mps, bodies, limits);
  const Surroundings b = look(seen.place(here_m), seen.way(v_mps), others, other_limits);
  EXPECT_NEAR(a.fence_now_m, b.fence_now_m, 1e-9);
  EXPECT_NEAR(a.fence_centre_m, b.fence_centre_m, 1e-9);
  EXPECT_NEAR(a.fence_stop_m, b.fence_stop_m, 1e-9);
  EXPECT_NEAR(a.obstacle_stop_m, b.obstacle_stop_m, 1e-9);
  EXPECT_NEAR(a.separation_now_m, b.separation_now_m, 1e-9);
  EXPECT_NEAR(a.separation_stop_m, b.separation_stop_m, 1e-9);
  EXPECT_EQ(a.yields, b.yields);
  EXPECT_NEAR(predicted_distance_m(here_m, bodies, 1.0),
              predicted_distance_m(seen.place(here_m), others, 1.0), 1e-9);
  EXPECT_EQ(is_occupied_below(here_m, bodies, limits),
            is_occupied_below(seen.place(here_m), others, other_limits));
  EXPECT_EQ(is_path_blocked(here_m, there_m, bodies, limits),
            is_path_blocked(seen.place(here_m), seen.place(there_m), others, other_limits));
  EXPECT_EQ(is_climb_blocked(here_m, 1.5, bodies, limits),
            is_climb_blocked(seen.place(here_m), 1.5, others, other_limits));
  // Any of several equally near spots may be returned, but their distance is unique.
  EXPECT_NEAR((landing_spot(here_m, bodies, limits) - here_m).norm(),
              (landing_spot(seen.place(here_m), others, other_limits) - seen.place(here_m)).norm(),
              1e-9);
  const auto spot_m = clear_spot(here_m, bodies, limits);
  const auto other_m = clear_spot(seen.place(here_m), others, other_limits);
  EXPECT_EQ(spot_m.has_value(), other_m.has_value());
  if (spot_m && other_m) {
    EXPECT_NEAR((*spot_m - here_m).norm(), (*other_m - seen.place(here_m)).norm(), 1e-9);
  }
}

TEST(Surroundings, AreInvariantUnderSymmetries) {
  test::Random random(43);
  for (int i = 0; i < 2000; ++i) {
    expect_the_same([](double x, double y) { return Eigen::Vector2d(x, -y); }, random);
    expect_the_same([](double x, double y) { return Eigen::Vector2d(-x, y); }, random);
    expect_the_same([](double x, double y) { return Eigen::Vector2d(-y, x); }, random);
    expect_the_same([](double x, double y) { return Eigen::Vector2d(x + 16.0, y - 8.0); }, random);
  }
}

// A body that is not a robot is assumed to keep its last speed for one second after mocap lost it.
// A larger radius reduces the distance.
TEST(Surroundings, AllowForTheMotionAndRadiusOfBodies) {
  const SafetyLimits limits = bench_limits();
  const Eigen::Vector3d here_m(0.0, -1.0, 1.0);
  OtherBody body;
  body.position_world_m = {2.5, -1.0, 1.0};
  const auto now_m = [&](double last_speed_mps, double age_s, double excess_radius_m) {
    body.last_speed_mps = last_speed_mps;
    body.age_s = age_s;
    body.excess_radius_m = excess_radius_m;
    return compute_surroundings(here_m, BrakingPath{}, {&body, 1}, limits).separation_now_m;
  };
  for (const double excess_radius_m : {0.0, 0.15}) {
    for (const double last_speed_mps : {0.0, 0.3, 0.5}) {
      EXPECT_NEAR(now_m(last_speed_mps, 0.6, excess_radius_m), 2.5 - 0.25 - excess_radius_m, 1e-9);
      EXPECT_NEAR(now_m(last_speed_mps, 9.0, excess_radius_m), 2.5 - 0.5 - excess_radius_m, 1e-9);
    }
    EXPECT_NEAR(now_m(1.2, 0.1, excess_radius_m), 2.5 - excess_radius_m, 1e-9);
    EXPECT_NEAR(now_m(1.2, 0.6, excess_radius_m), 2.5 - 0.6 - excess_radius_m, 1e-9);
    EXPECT_NEAR(now_m(1.2, 1.0, excess_radius_m), 2.5 - 1.08 - excess_radius_m, 1e-9);
    EXPECT_NEAR(now_m(1.2, 9.0, excess_radius_m), 2.5 - 1.2 - excess_radius_m, 1e-9);
    EXPECT_NEAR(predicted_distance_m(here_m, {&body, 1}, 1.0), 2.5 - excess_radius_m, 1e-9);
  }
  const auto nearest_m = [&](double excess_radius_m, const auto& is_free) {
    return test::last_accepted(3.0, 0.0, 1e-9, [&](double y_m) {
      OtherBody other;
      other.excess_radius_m = excess_radius_m;
      other.position_world_m = here_m + Eigen::Vector3d(1.0, y_m, 0.0);
      return is_free(other);
    });
  };
  const Eigen::Vector3d to_m = here_m + Eigen::Vector3d(2.0, 0.0, 0.0);
  for (const double excess_radius_m : {0.0, 0.15}) {
    EXPECT_NEAR(nearest_m(excess_radius_m,
                          [&](const OtherBody& other) {
                            return !is_path_blocked(here_m, to_m, {&other, 1}, limits);
                          }),
                limits.separation_hold_m + excess_radius_m, 1e-7);
    EXPECT_NEAR(nearest_m(excess_radius_m,
                          [&](const OtherBody& other) {
                            const Eigen::Vector3d above_m = here_m + Eigen::Vector3d(1.0, 0.0, 0.9);
                            return !is_occupied_below(above_m, {&other, 1}, limits);
                          }),
                limits.landing_clearance_m + excess_radius_m, 1e-7);
  }
}

// Finds by bisection, from both sides, the distance at which each rule begins to apply.
TEST(Surroundings, HaveTheStatedMargins) {
  const SafetyLimits limits = bench_limits();
  const Eigen::Vector3d here_m(0.0, -1.0, 1.0);
  for (const double side : {1.0, -1.0}) {
    const auto at = [&](double x_m, double z_m) {
      OtherBody body;
      body.position_world_m = here_m + Eigen::Vector3d(side * x_m, 0.0, z_m);
      return body;
    };
    for (const double age_s : {0.0, 0.6, 9.0}) {
      const double tube_m = std::clamp(0.5 * (age_s - 0.1), 0.0, 0.5);
      const double below_m = test::last_accepted(3.0, 0.0, 1e-9, [&](double x_m) {
        OtherBody body = at(x_m, -0.9);
        body.age_s = age_s;
        return !is_occupied_below(here_m, {&body, 1}, limits, 0.03);
      });
      EXPECT_NEAR(below_m, limits.landing_clearance_m + 0.03 + tube_m, 1e-8) << age_s;
      const double above_m = test::last_accepted(3.0, 0.0, 1e-9, [&](double x_m) {
        OtherBody body = at(x_m, 0.5);
        body.age_s = age_s;
        body.robot = 1;
        return !is_climb_blocked(here_m, 2.0, {&body, 1}, limits);
      });
      EXPECT_NEAR(above_m, limits.separation_hold_m + 0.25 + tube_m, 1e-8) << age_s;
    }
    // A robot at the vehicle's height counts as below if it has priority. Robots above do not block
    // a landing.
    const auto occupies = [&](double z_m, bool has_priority, int robot = 2) {
      OtherBody body = at(0.2, z_m);
      body.has_priority = has_priority;
      body.robot = robot;
      return is_occupied_below(here_m, {&body, 1}, limits);
    };
    EXPECT_NEAR(test::last_accepted(-0.9, 0.9, 1e-9, [&](double z) { return occupies(z, false); }),
                -0.3, 1e-8);
    EXPECT_NEAR(test::last_accepted(-0.9, 0.9, 1e-9, [&](double z) { return occupies(z, true); }),
                0.3, 1e-8);
    for (const double z_m : {-0.9, -0.2, 0.2, 0.75, 2.0}) {
      EXPECT_TRUE(occupies(z_m, true, -1)) << "a person, from the helmet down to the ground";
    }
    // A path is blocked if a body comes closer to it than separation_hold_m and than the body's
    // current distance.
    const Eigen::Vector3d to_m = here_m + Eigen::Vector3d(2.0, 0.0, 0.0);
    const double beside_m = test::last_accepted(2.0, 0.0, 1e-9, [&](double y_m) {
      OtherBody body;
      body.position_world_m = here_m + Eigen::Vector3d(1.0, side * y_m, 0.0);
      return !is_path_blocked(here_m, to_m, {&body, 1}, limits);
    });
    EXPECT_NEAR(beside_m, limits.separation_hold_m, 1e-7);
    // A passing body counts. A stationary robot that waits for its turn does not.
    OtherBody walker = at(1.5, 0.4);
    walker.velocity_world_mps = {-side, 0.0, 0.3};
    EXPECT_NEAR(predicted_distance_m(here_m, {&walker, 1}, 1.0), 0.5, 1e-9);
    EXPECT_NEAR(predicted_distance_m(here_m, {&walker, 1}, 0.2), 1.3, 1e-9);
    walker.robot = 2;
    EXPECT_NEAR(predicted_distance_m(here_m, {&walker, 1}, 1.0), 0.5, 1e-9);
    const double stands_mps = test::last_accepted(0.0, 0.5, 1e-9, [&](double v_mps) {
      walker.velocity_world_mps = {0.0, v_mps, 0.0};
      return std::isinf(predicted_distance_m(here_m, {&walker, 1}, 1.0));
    });
    EXPECT_NEAR(stands_mps, 0.1, 1e-8);
    walker.robot = -1;
    walker.velocity_world_mps.setZero();
    EXPECT_NEAR(predicted_distance_m(here_m, {&walker, 1}, 1.0), 1.5, 1e-9)
        << "a robot that waits for its turn does not count";
  }
}

// Only robots within a range of heights block a climb. Both ends of the range are found by
// bisection.
TEST(IsClimbBlocked, HasTheStatedHeightLimits) {
  const SafetyLimits limits = bench_limits();
  const Eigen::Vector3d here_m(0.0, -1.0, 0.3);
  const auto is_taken = [&](double z_m) {
    OtherBody body;
    body.position_world_m = {0.1, -1.0, z_m};
    body.robot = 0;
    return is_climb_blocked(here_m, 1.0, {&body, 1}, limits);
  };
  EXPECT_NEAR(test::last_accepted(0.8, 0.0, 1e-9, is_taken), 0.3, 1e-8);
  EXPECT_NEAR(test::last_accepted(0.8, 3.0, 1e-9, is_taken), 1.0 + limits.separation_hold_m, 1e-8);
}

}  // namespace
}  // namespace vantage::drivers
