#include "planner/tour/tour_planner.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "planner/problem/fixed_information.hpp"
#include "test/support/allocation_counter.hpp"

namespace vantage::planner {
namespace {

constexpr double kSpeed_mps = 2.0;
constexpr double kNear_m = 6.0;  // distance at which a stop is reached: 0.6 of the range

SearchTarget still_target(double x_m, double y_m, double sigma_m = 2.0) {
  return {{models::TargetKind::kStatic, 2, 0.0},
          {Eigen::Vector2d(x_m, y_m), sigma_m * sigma_m * Eigen::Matrix2d::Identity()}};
}

SearchTarget moving_target(double x_m, double y_m, double vx_mps) {
  SearchTarget target;
  target.model = {models::TargetKind::kDoubleIntegrator, 2, 0.01};
  target.prior.mean = Eigen::Vector4d(x_m, y_m, vx_mps, 0.0);
  target.prior.covariance = 0.1 * Eigen::Matrix4d::Identity();
  return target;
}

SearchProblem empty_problem() {
  SearchProblem problem;
  problem.horizon_steps = 4;
  problem.controls = {{kSpeed_mps, 0.0}, {kSpeed_mps, 1.0}, {1.0, -1.0}};
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kPosition;
  sensor.range_max_m = 10.0;
  sensor.position_sigma_m = 0.5;
  problem.sensors = {sensor};
  return problem;
}

scenario::TourSpec spec_of(double horizon_s) { return {horizon_s, 1.0, 1.0}; }

FixedTeammate teammate_at(double x_m, double y_m) {
  FixedTeammate teammate;
  teammate.trajectory.start = {x_m, y_m, 0.0};
  return teammate;
}

std::vector<int> targets_of(std::span<const TourStop> tour) {
  std::vector<int> targets;
  for (const TourStop& stop : tour) {
    targets.push_back(stop.target);
  }
  return targets;
}

// A measurement of a static target keeps its effect. The gain is therefore the cost saved per step
// times the number of remaining steps, and falls at a constant rate with the arrival time.
TEST(TourPlanner, GainsTheCostSavedByMeasuringAStaticTarget) {
  SearchProblem problem = empty_problem();
  problem.targets = {still_target(20.0, 0.0)};
  TourPlanner planner(4);
  const auto tour = planner.plan(problem, {}, spec_of(80.0));
  ASSERT_EQ(targets_of(tour), std::vector<int>{0});
  EXPECT_DOUBLE_EQ(tour[0].arrival_s, (20.0 - kNear_m) / kSpeed_mps);
  // Two measurements of information 4 m⁻² in both directions; prior variance 4 m². The target is
  // found with the probability that it is within 5 m of its mean.
  const double saved_nats = 2.0 * std::log(1.0 + 2.0 * 4.0 * 4.0);
  const double found = 1.0 - std::exp(-0.5 * 25.0 / 4.0);
  EXPECT_NEAR(tour[0].rate_per_s, found * saved_nats / problem.step_s, 1e-9);
  EXPECT_NEAR(planner.solver().gain(), found * saved_nats * (80.0 - 7.0) / problem.step_s, 1e-9);
}

TEST(TourPlanner, UsesTheTraceAsCostIfTheProblemDoes) {
  SearchProblem problem = empty_problem();
  problem.cost = CostKind::kTrace;
  problem.targets = {still_target(20.0, 0.0)};
  TourPlanner planner(4);
  const auto tour = planner.plan(problem, {}, spec_of(80.0));
  ASSERT_EQ(tour.size(), 1u);
  const double saved_m2 = 2.0 * (4.0 - 1.0 / (0.25 + 8.0));
  const double found = 1.0 - std::exp(-0.5 * 25.0 / 4.0);
  EXPECT_NEAR(tour[0].rate_per_s, found * saved_m2 / problem.step_s, 1e-9);
}

TEST(TourPlanner, VisitsEqualTargetsOnALineInOrder) {
  SearchProblem problem = empty_problem();
  problem.targets = {still_target(30.0, 0.0), still_target(10.0, 0.0), still_target(20.0, 0.0)};
  TourPlanner planner(4);
  const auto tour = planner.plan(problem, {}, spec_of(80.0));
  EXPECT_EQ(targets_of(tour), (std::vector<int>{1, 2, 0}));
  EXPECT_DOUBLE_EQ(tour[1].arrival_s, 2.0 + 1.0 + 2.0);
  EXPECT_DOUBLE_EQ(tour[1].path_s, 1.0 + 5.0);
}

TEST(TourPlanner, PrefersTheLessCertainOfTwoTargets) {
  SearchProblem problem = empty_problem();
  problem.targets = {still_target(20.0, 0.0, 0.5), still_target(-20.0, 0.0, 2.5)};
  TourPlanner planner(4);
  EXPECT_EQ(targets_of(planner.plan(problem, {}, spec_of(80.0))), (std::vector<int>{1, 0}));
}

// Teammates with sensors that measure velocity send information about position and velocity.
TEST(TourPlanner, UsesInformationAboutPositionOrState) {
  SearchProblem problem = empty_problem();
  problem.targets = {moving_target(20.0, 0.0, 0.0), moving_target(-20.0, 0.0, 0.0)};
  SearchProblem with_velocity = problem;
  const Eigen::Matrix2d M = 3.0 * Eigen::Matrix2d::Identity();
  Eigen::Matrix4d whole = Eigen::Matrix4d::Zero();
  whole.topLeftCorner<2, 2>() = M;
  for (int m = 0; m < 2; ++m) {
    problem.fixed_information.emplace_back(4,
                                           m == 0 ? models::StateMatrix(M) : models::StateMatrix());
    with_velocity.fixed_information.emplace_back(
        4, m == 0 ? models::StateMatrix(whole) : models::StateMatrix());
  }
  const std::vector<FixedTeammate> team = {teammate_at(200.0, 0.0)};
  TourPlanner planner(4);
  TourPlanner other(4);
  const auto expected = planner.plan(problem, team, spec_of(80.0));
  const auto tour = other.plan(with_velocity, team, spec_of(80.0));
  ASSERT_EQ(targets_of(tour), targets_of(expected));
  ASSERT_FALSE(tour.empty());
  for (std::size_t i = 0; i < tour.size(); ++i) {
    EXPECT_NEAR(tour[i].rate_per_s, expected[i].rate_per_s, 1e-9 * expected[i].rate_per_s);
    EXPECT_NEAR(tour[i].open, expected[i].open, 1e-9 * std::abs(expected[i].open));
  }
}

// The landmark of a region is planar; the targets have a height.
TEST(TourPlanner, PlansVisitsOfRegionsWithTargetsInSpace) {
  SearchProblem problem = empty_problem();
  problem.targets = {still_target(20.0, 0.0)};
  TourRegions regions;
  regions.undiscovered.model = {models::TargetKind::kRandomWalk, 3, 0.01};
  regions.undiscovered.prior = {Eigen::Vector3d(0.0, 0.0, 0.5),
                                100.0 * Eigen::Matrix3d::Identity()};
  regions.regions = {{0, 0.5}};
  TourPlanner planner(4);
  double rate_per_s = 0.0;
  for (int repetition = 0; repetition < 3; ++repetition) {
    const auto tour = planner.plan(problem, {}, spec_of(80.0), regions);
    ASSERT_EQ(targets_of(tour), std::vector<int>{0});
    EXPECT_GT(tour[0].rate_per_s, 0.0);
    EXPECT_TRUE(repetition == 0 || tour[0].rate_per_s == rate_per_s);
    rate_per_s = tour[0].rate_per_s;
  }
}

TEST(TourPlanner, OmitsStopsThatItCannotReachInTime) {
  SearchProblem problem = empty_problem();
  problem.targets = {still_target(20.0, 0.0), still_target(100.0, 0.0)};
  TourPlanner planner(4);
  EXPECT_EQ(targets_of(planner.plan(problem, {}, spec_of(30.0))), std::vector<int>{0});
  EXPECT_TRUE(planner.plan(problem, {}, spec_of(0.0)).empty());
  EXPECT_TRUE(planner.terminal_value().is_empty());
}

TEST(TourPlanner, LeavesStopsToNearerTeammates) {
  SearchProblem problem = empty_problem();
  problem.targets = {still_target(20.0, 0.0), still_target(-40.0, 0.0)};
  TourPlanner planner(4);
  std::vector<FixedTeammate> team = {teammate_at(-35.0, 0.0)};
  EXPECT_EQ(targets_of(planner.plan(problem, team, spec_of(80.0))), std::vector<int>{0});
  team[0].jammed = true;
  EXPECT_EQ(targets_of(planner.plan(problem, team, spec_of(80.0))), (std::vector<int>{0, 1}));
}

// A teammate plans to measure one of two equal targets, so a visit to this target gains less.
TEST(TourPlanner, AllowsForPlannedMeasurementsOfTeammates) {
  SearchProblem problem = empty_problem();
  problem.targets = {still_target(20.0, 0.0), still_target(-20.0, 0.0)};
  const models::PositionMatrix none;
  const models::PositionMatrix strong = 100.0 * Eigen::Matrix2d::Identity();
  problem.fixed_information = {{none, strong, strong, none}, {none, none, none, none}};
  TourPlanner planner(4);
  const std::vector<FixedTeammate> team = {teammate_at(200.0, 0.0)};
  const auto tour = planner.plan(problem, team, spec_of(80.0));
  ASSERT_EQ(targets_of(tour), (std::vector<int>{1, 0}));
  EXPECT_LT(tour[1].rate_per_s, 0.1 * tour[0].rate_per_s);
  const auto alone = planner.plan(problem, {}, spec_of(80.0));
  ASSERT_EQ(alone.size(), 2u);
  EXPECT_NEAR(alone[1].rate_per_s, alone[0].rate_per_s, 1e-9);
}

// Without a visit, the variance of a random walk grows linearly. The gain of an immediate visit is
// the integral of the saved cost, by the trapezoidal rule over eight intervals.
TEST(TourPlanner, PredictsTheCovarianceWithoutAVisitByTheMotionModel) {
  constexpr double kQ_m2ps = 0.05;
  constexpr double kSample_s = 10.0;
  SearchProblem problem = empty_problem();
  problem.targets = {still_target(0.0, 0.0)};
  problem.targets[0].model = {models::TargetKind::kRandomWalk, 2, kQ_m2ps};
  TourPlanner planner(4);
  const auto tour = planner.plan(problem, {}, spec_of(8.0 * kSample_s));
  ASSERT_EQ(tour.size(), 1u);
  EXPECT_EQ(tour[0].arrival_s, 0.0);
  const double prior_m2 = 4.0 + kQ_m2ps * problem.horizon_steps * problem.step_s;
  const double seen_once_m2 = 1.0 / (1.0 / prior_m2 + 4.0) + kQ_m2ps * problem.step_s;
  const double visited_m2 = 1.0 / (1.0 / seen_once_m2 + 4.0);
  double sum_nats = 0.0;
  for (int k = 0; k <= 8; ++k) {
    const double grown_m2 = kQ_m2ps * kSample_s * k;
    const double saved_nats = 2.0 * std::log((prior_m2 + grown_m2) / (visited_m2 + grown_m2));
    sum_nats += (k == 0 || k == 8 ? 0.5 : 1.0) * saved_nats;
  }
  const double found = 1.0 - std::exp(-0.5 * 25.0 / prior_m2);
  EXPECT_NEAR(planner.solver().gain(), found * sum_nats * kSample_s / problem.step_s, 1e-9);
}

TEST(TourPlanner, TravelsAroundObstacles) {
  SearchProblem problem = empty_problem();
  models::World world;
  world.bounds = {{-50.0, -50.0}, {50.0, 50.0}};
  world.obstacles.push_back({{{9.0, -30.0}, {11.0, 40.0}}, 10.0});
  problem.world = &world;
  problem.targets = {still_target(20.0, 0.0)};
  TourPlanner planner(4);
  const auto tour = planner.plan(problem, {}, spec_of(160.0));
  ASSERT_EQ(tour.size(), 1u);
  const double path_m = std::hypot(9.0, 30.0) + 2.0 + std::hypot(9.0, 30.0);
  EXPECT_NEAR(tour[0].arrival_s, (path_m - kNear_m) / kSpeed_mps, 1e-5);
  const TerminalValue value = planner.terminal_value();
  ASSERT_FALSE(value.is_empty());
  const double here = value.at(value.rest({}), {0.0, 0.0});
  EXPECT_NEAR(here, tour[0].rate_per_s * path_m / kSpeed_mps, 0.02 * here);
  EXPECT_LT(value.at(value.rest({}), {0.0, -3.0}), here) << "the path leads to the south";
  EXPECT_GT(value.at(value.rest({}), {3.0, 3.0}), here);
}

TEST(TourPlanner, GivesATerminalValueThatFallsTowardsTheTour) {
  SearchProblem problem = empty_problem();
  problem.targets = {still_target(30.0, 0.0), still_target(10.0, 0.0)};
  TourPlanner planner(4);
  scenario::TourSpec spec = spec_of(80.0);
  spec.weight = 0.5;
  const auto tour = planner.plan(problem, {}, spec);
  ASSERT_EQ(targets_of(tour), (std::vector<int>{1, 0}));
  const TerminalValue value = planner.terminal_value();
  const double sum = tour[0].rate_per_s + tour[1].rate_per_s;
  const auto v = [&](double x_m) { return value.at(value.rest({}), {x_m, 0.0}); };
  EXPECT_NEAR(v(0.0) - v(2.0), 0.5 * sum * 2.0 / kSpeed_mps, 1e-6);
  EXPECT_NEAR(v(0.0), 0.5 * (sum * 5.0 + tour[1].rate_per_s * 11.0), 1e-6);
  const std::uint16_t near[] = {1};
  EXPECT_NEAR(value.at(value.rest(near), {0.0, 0.0}), 0.5 * tour[1].rate_per_s * 15.0, 1e-6);
}

// The gain of a region is proportional to its expected number of undiscovered targets, with a
// weight of 4.
TEST(TourPlanner, VisitsUnexploredRegionsByTheirExpectedTargets) {
  SearchProblem problem = empty_problem();
  problem.targets = {still_target(20.0, 0.0), still_target(-20.0, 0.0)};
  TourRegions regions;
  regions.undiscovered = still_target(0.0, 0.0, 10.0);
  regions.regions = {{0, 0.2}, {1, 0.5}};
  TourPlanner planner(4);
  const auto tour = planner.plan(problem, {}, spec_of(80.0), regions);
  ASSERT_EQ(targets_of(tour), (std::vector<int>{1, 0}));
  const double saved_nats = 2.0 * std::log(1.0 + 2.0 * 4.0 * 100.0);
  EXPECT_NEAR(tour[0].rate_per_s, 4.0 * 0.5 * saved_nats / problem.step_s, 1e-9);
  EXPECT_NEAR(tour[1].rate_per_s, 4.0 * 0.2 * saved_nats / problem.step_s, 1e-9);
  // A region counts as visited after one measurement of its landmark.
  EXPECT_EQ(tour[0].done, tour[0].open);
}

// A stop is complete when 0.7 of the cost that a visit saves has been saved.
TEST(TourPlanner, KeepsAStopUntilMostOfItsCostIsSaved) {
  SearchProblem problem = empty_problem();
  problem.targets = {still_target(20.0, 0.0)};
  TourPlanner planner(4);
  planner.plan(problem, {}, spec_of(80.0));
  const TerminalValue value = planner.terminal_value();
  ASSERT_EQ(value.stops().size(), 1u);
  const double open = 2.0 * std::log(4.0);
  const double saved_nats = 2.0 * std::log(1.0 + 2.0 * 4.0 * 4.0);
  EXPECT_NEAR(value.stops()[0].open, open, 1e-12);
  EXPECT_NEAR(value.stops()[0].done, open - 0.7 * saved_nats, 1e-9);
}

TEST(TourPlanner, AllocatesNothingInPlan) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the sanitizer has its own allocator";
  }
  SearchProblem problem = empty_problem();
  models::World world;
  world.bounds = {{-100.0, -100.0}, {100.0, 100.0}};
  world.obstacles.push_back({{{9.0, -30.0}, {11.0, 40.0}}, 10.0});
  problem.world = &world;
  for (int i = 0; i < 150; ++i) {  // more than there are stops
    const double x_m = 90.0 * std::sin(3.0 * i);
    const double y_m = 90.0 * std::cos(5.0 * i);
    problem.targets.push_back(i % 2 == 0 ? still_target(x_m, y_m) : moving_target(x_m, y_m, 0.2));
  }
  std::vector<FixedTeammate> team;
  for (int i = 0; i < 12; ++i) {
    team.push_back(teammate_at(-80.0 + 10.0 * i, 5.0));
  }
  TourPlanner planner(150);
  const test::AllocationCounter allocations;
  const auto tour = planner.plan(problem, team, spec_of(120.0));
  EXPECT_EQ(allocations.count(), 0u);
  EXPECT_FALSE(tour.empty());
  EXPECT_LE(planner.solver().work_nodes(), TourPlanner::kVisitsMax + 4 * TourPlanner::kStopsMax);
}

}  // namespace
}  // namespace vantage::planner
