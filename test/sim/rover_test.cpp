#include "sim/rover/rover.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "sim/rover/drifters.hpp"
#include "sim/rover/fleet.hpp"
#include "sim/rover/route.hpp"
#include "sim/rover/starts.hpp"
#include "test/sim/lab_scenario.hpp"

namespace vantage::sim {
namespace {

constexpr double kDtS = 0.005;

TEST(StepRover, RampsToItsSpeed) {
  const RoverParameters parameters;
  RoverState state;
  double travelled_m = 0.0;
  for (int i = 0; i < 400; ++i) {
    state = step_rover(state, {5.0, 0.0}, parameters, kDtS);
    EXPECT_LE(state.speed_mps, 1.4);
    travelled_m = state.world_from_body.x_m;
  }
  // 1.4 s of acceleration at 1 m/s², then 0.6 s at 1.4 m/s.
  EXPECT_NEAR(travelled_m, 0.5 * 1.4 * 1.4 + 0.6 * 1.4, 1e-9);
}

TEST(StepRover, DrivesACircleOfRadiusSpeedOverYawRate) {
  const RoverParameters parameters;
  RoverState state{{}, 0.5, 1.0};
  for (int i = 0; i < 20000; ++i) {
    state = step_rover(state, {0.5, 1.0}, parameters, kDtS);
    EXPECT_NEAR((state.world_from_body.position_m() - Eigen::Vector2d(0.0, 0.5)).norm(), 0.5, 1e-5);
  }
}

TEST(StoppingPath, EndsAtStandstillAfterTheBrakingDistance) {
  const StoppingPath path({{}, 1.4, 0.0}, {0.0, 0.0}, {}, 0.05);
  EXPECT_NEAR(path.points_m().back().x(), 1.4 * 1.4 / (2.0 * 2.0), 1e-9);
}

TEST(StoppingPath, DistanceAgreesWithDenseSampling) {
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const RoverParameters parameters;
  for (int trial = 0; trial < 300; ++trial) {
    const RoverState a{{u(rng), u(rng), 3.0 * u(rng)}, 0.7 + 0.7 * u(rng), u(rng)};
    const RoverState b{{u(rng), u(rng), 3.0 * u(rng)}, 0.7 + 0.7 * u(rng), u(rng)};
    const StoppingPath path_a(a, {a.speed_mps, 0.0}, parameters, 0.05);
    const StoppingPath path_b(b, {b.speed_mps, 0.0}, parameters, 0.05);
    // The reference treats both paths as straight pieces and compares them by dense sampling.
    double exact_m = 1e9;
    const auto pa = path_a.points_m();
    const auto pb = path_b.points_m();
    for (std::size_t i = 0; i + 1 < pa.size(); ++i) {
      for (std::size_t j = 0; j + 1 < pb.size(); ++j) {
        for (int k = 0; k <= 10; ++k) {
          const Eigen::Vector2d p = pa[i] + 0.1 * k * (pa[i + 1] - pa[i]);
          for (int l = 0; l <= 10; ++l) {
            exact_m = std::min(exact_m, (p - pb[j] - 0.1 * l * (pb[j + 1] - pb[j])).norm());
          }
        }
      }
    }
    const double found_m = distance_m(path_a, path_b);
    if (found_m > 2.0) {
      EXPECT_LE(found_m, exact_m + 1e-12);
    } else {
      EXPECT_NEAR(found_m, exact_m, 0.04);
    }
  }
}

TEST(RouteMap, AvoidsABoxWithClearance) {
  const models::World world = test::lab_scenario().world;
  const RouteMap map(world);
  const Eigen::Vector2d from_m(1.25, 1.5);
  const Eigen::Vector2d to_m(1.25, 4.0);
  const auto path = map.route(from_m, to_m, 0.2, {});
  ASSERT_FALSE(path.empty());
  EXPECT_EQ(path.back(), to_m);
  Eigen::Vector2d last = path.front();
  double length_m = (last - from_m).norm();
  for (const Eigen::Vector2d& point : path) {
    EXPECT_GE(models::swept_clearance_m(world, last, point), 0.25);
    length_m += (point - last).norm();
    last = point;
  }
  EXPECT_GT(length_m, 2.5);
  EXPECT_LT(length_m, 3.6);
}

TEST(RouteMap, FindsNoRouteThroughAWallOfDiscs) {
  const models::World world = test::lab_scenario().world;
  const RouteMap map(world);
  std::vector<Disc> wall;
  for (int i = 0; i <= 8; ++i) {
    wall.push_back({{0.5 * i, 4.0}, 0.5});
  }
  EXPECT_TRUE(map.route({2.0, 1.0}, {2.0, 7.0}, 0.2, wall).empty());
  EXPECT_FALSE(map.route({2.0, 1.0}, {2.0, 3.0}, 0.2, wall).empty());
  EXPECT_TRUE(map.route({2.0, 1.0}, {1.25, 2.75}, 0.2, {}).empty()) << "inside a box";
}

TEST(TargetStarts, AreFreeSeparateAndDeterministic) {
  const scenario::Scenario scenario = test::lab_scenario();
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto starts = target_starts(scenario, seed);
    ASSERT_EQ(starts.size(), 5u);
    EXPECT_EQ(starts, target_starts(scenario, seed));
    EXPECT_NE(starts, target_starts(scenario, seed + 1));
    for (std::size_t i = 0; i < starts.size(); ++i) {
      EXPECT_GE(models::clearance_m(scenario.world, starts[i].position_m()), 0.2);
      for (std::size_t j = i + 1; j < starts.size(); ++j) {
        EXPECT_GE((starts[i].position_m() - starts[j].position_m()).norm(), 0.4);
      }
      for (const auto& robot : scenario.robots) {
        EXPECT_GE((starts[i].position_m() - robot.start.position_m()).norm(), 1.0);
      }
    }
  }
}

TEST(TargetStarts, RefusesAFullLab) {
  scenario::Scenario scenario = test::lab_scenario();
  for (auto& target : scenario.targets) {
    target.radius_m = 1.9;
  }
  EXPECT_THROW(target_starts(scenario, 1), UsageError);
}

// For each of twenty seeds, five rovers drive for five minutes among two boxes. They do not touch
// anything, keep their limits, and cover distance.
class RoversFor300S : public ::testing::TestWithParam<int> {};

TEST_P(RoversFor300S, NeverTouchAndReachWaypoints) {
  const scenario::Scenario scenario = test::lab_scenario();
  const auto seed = static_cast<std::uint64_t>(GetParam());
  std::vector<RoverFleet::Start> starts;
  for (const Pose2& pose : target_starts(scenario, seed)) {
    starts.push_back({pose, 0.2});
  }
  RoverFleet fleet(scenario.world, scenario.target_truth, starts, seed);
  const RoverParameters limits;
  double wall_m = 1e9;
  double pair_m = 1e9;
  double speed_mps = 0.0;
  double travelled_m = 0.0;
  double yaw_rate_radps = 0.0;
  std::vector<double> each_m(5, 0.0);
  constexpr int kSteps = 60000;
  for (int step = 0; step < kSteps; ++step) {
    if (step % 10 == 0) {
      fleet.decide(RoverFleet::kDecisionPeriodS);
    }
    fleet.step(kDtS);
    for (std::size_t i = 0; i < fleet.size(); ++i) {
      const RoverState& state = fleet.state(i);
      const Eigen::Vector2d here_m = state.world_from_body.position_m();
      wall_m = std::min(wall_m, models::clearance_m(scenario.world, here_m) - 0.2);
      speed_mps = std::max(speed_mps, state.speed_mps);
      yaw_rate_radps = std::max(yaw_rate_radps, std::abs(state.yaw_rate_radps));
      each_m[i] += state.speed_mps * kDtS;
      for (std::size_t j = i + 1; j < fleet.size(); ++j) {
        pair_m =
            std::min(pair_m, (here_m - fleet.state(j).world_from_body.position_m()).norm() - 0.4);
      }
    }
  }
  for (const double metres : each_m) {
    travelled_m += metres / 5.0;
    EXPECT_GT(metres, 15.0) << "the rover hardly moves";
  }
  EXPECT_GT(wall_m, 0.0);
  EXPECT_GT(pair_m, 0.0);
  EXPECT_LE(speed_mps, scenario.target_truth.speed_max_mps + 1e-12);
  EXPECT_LE(yaw_rate_radps, limits.yaw_rate_max_radps + 1e-12);
  EXPECT_GT(fleet.way_points_reached(), 5 * 10);
  std::cout << "seed " << seed << ": mean speed " << travelled_m / 300.0 << " m/s, least "
            << *std::min_element(each_m.begin(), each_m.end()) / 300.0 << ", way points "
            << fleet.way_points_reached() << " reached " << fleet.way_points_abandoned()
            << " abandoned, gap to walls " << wall_m << " m, between rovers " << pair_m << " m\n";
}

INSTANTIATE_TEST_SUITE_P(Seeds, RoversFor300S, ::testing::Range(1, 21));

TEST(RoverFleet, RefusesAnUndrivableSpeed) {
  const scenario::Scenario scenario = test::lab_scenario();
  scenario::TargetTruthSpec truth;
  truth.speed_max_mps = 1.5;
  EXPECT_THROW(RoverFleet(scenario.world, truth, {}, 1), UsageError);
}

// A rover that reached its goal slowly must also stay there: the reaction to a lack of progress
// must not act after the arrival.
TEST(RoverFleet, StaysAtItsGoal) {
  models::World world;
  world.bounds = {{-1.0, -1.0}, {1.0, 1.0}};
  scenario::TargetTruthSpec truth;
  truth.speed_min_mps = 0.08;
  truth.speed_max_mps = 0.098;
  truth.pause_max_s = 1.0;
  RoverFleet fleet(world, truth, {{{0.4, -0.3, 0.0}, 0.1}}, 1);
  for (int i = 0; i < 40'000; ++i) {
    const std::int64_t before = fleet.way_points_reached();
    fleet.decide(RoverFleet::kDecisionPeriodS);
    fleet.step(RoverFleet::kDecisionPeriodS);
    if (fleet.way_points_reached() > before) {
      ASSERT_EQ(fleet.state(0).speed_mps, 0.0) << " waypoint " << before;
    }
  }
  EXPECT_GT(fleet.way_points_reached(), 150);
  EXPECT_EQ(fleet.way_points_abandoned(), 0);
}

// A bounce off a wall reverses one velocity component; a bounce in a corner reverses both.
TEST(Drifters, KeepTangentialVelocityWhenTheyBounce) {
  models::World world;
  world.bounds = {{-5.0, -5.0}, {5.0, 5.0}};
  Drifters drifters(world, {{{0.0, 0.0}, 0.2}}, 0.05, 2.0, 3);
  int bounces[2] = {};
  for (int step = 0; step < 60'000; ++step) {
    const Eigen::Vector2d before_m = drifters.disc(0).centre_m;
    const Eigen::Vector2d before_mps = drifters.velocity_mps(0);
    drifters.step(kDtS);
    const bool is_in_a_corner = before_m.cwiseAbs().minCoeff() > 4.5;
    if (drifters.disc(0).centre_m != before_m || is_in_a_corner ||
        before_mps.cwiseAbs().minCoeff() < 0.1) {
      continue;
    }
    const Eigen::Array2d turned = drifters.velocity_mps(0).array() * before_mps.array();
    EXPECT_EQ((turned < 0.0).count(), 1) << before_m.transpose();
    ++bounces[turned.x() < 0.0 ? 0 : 1];
  }
  EXPECT_GT(bounces[0], 5);
  EXPECT_GT(bounces[1], 5);
}

TEST(Drifters, StayInsideAndApartForTenMinutes) {
  const models::World world = test::lab_scenario().world;
  const std::vector<Disc> starts{{{0.5, 0.5}, 0.2},
                                 {{1.0, 0.5}, 0.2},
                                 {{2.0, 4.0}, 0.2},
                                 {{3.0, 7.0}, 0.2},
                                 {{3.5, 2.0}, 0.2}};
  Drifters drifters(world, starts, 0.05, 2.0, 3);
  double apart_m = 1e9;
  double wall_m = 1e9;
  double speed_mps = 0.0;
  for (int step = 0; step < 120000; ++step) {
    drifters.step(kDtS);
    for (std::size_t i = 0; i < drifters.size(); ++i) {
      wall_m = std::min(wall_m, models::clearance_m(world, drifters.disc(i).centre_m) - 0.2);
      speed_mps = std::max(speed_mps, drifters.velocity_mps(i).norm());
      for (std::size_t j = i + 1; j < drifters.size(); ++j) {
        apart_m =
            std::min(apart_m, (drifters.disc(i).centre_m - drifters.disc(j).centre_m).norm() - 0.4);
      }
    }
  }
  EXPECT_GT(wall_m, 0.0);
  EXPECT_GT(apart_m, 0.0);
  EXPECT_LE(speed_mps, 2.0 + 1e-12);
  EXPECT_GT(speed_mps, 0.5);
}

TEST(Drifters, SpreadLikeADoubleIntegrator) {
  // Far from any wall, var v = q t and var p = q t³/3 on each axis.
  models::World world;
  world.bounds = {{-1e4, -1e4}, {1e4, 1e4}};
  std::vector<Disc> starts;
  for (int i = 0; i < 400; ++i) {
    starts.push_back({{10.0 * (i % 20), 10.0 * (i / 20)}, 0.01});
  }
  Drifters drifters(world, starts, 0.01, 100.0, 11);
  for (int step = 0; step < 800; ++step) {
    drifters.step(kDtS);
  }
  double v2 = 0.0;
  double p2 = 0.0;
  for (std::size_t i = 0; i < drifters.size(); ++i) {
    v2 += drifters.velocity_mps(i).squaredNorm();
    p2 += (drifters.disc(i).centre_m - starts[i].centre_m).squaredNorm();
  }
  // With 800 samples, the relative standard deviation of a variance is √(2/800) = 5 %. The
  // tolerance is 4σ.
  EXPECT_NEAR(v2 / 800.0 / (0.01 * 4.0), 1.0, 0.2);
  EXPECT_NEAR(p2 / 800.0 / (0.01 * 64.0 / 3.0), 1.0, 0.2);
}

}  // namespace
}  // namespace vantage::sim
