#include "planner/problem/belief_table.hpp"

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "planner/problem/fixed_information.hpp"
#include "planner/problem/information_at.hpp"
#include "planner/problem/lanes.hpp"
#include "planner/problem/log_product.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/support/allocation_counter.hpp"
#include "test/support/near.hpp"

namespace vantage::planner {
namespace {

using test::is_near;
using test::pick;
using test::uniform;

// One table is reused for all problems. It contains the model's prediction for each target and
// depth, and no value of the previous problem.
TEST(BeliefTable, EqualsModelPredictionAtEachDepth) {
  BeliefTable table(6, 5);
  int fixed = 0;
  int unfixed = 0;
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    OwnedProblem owned = test::random_problem(seed);
    SearchProblem& problem = owned.problem;
    if (seed % 7 == 0) {
      for (auto& steps : problem.fixed_information) {
        steps.emplace_back(Eigen::Matrix2d::Identity());  // a step beyond the horizon
      }
    }
    table.reset(problem);
    ASSERT_EQ(table.target_count(), static_cast<int>(problem.targets.size()));
    EXPECT_EQ(table.cost(), problem.cost);
    bool is_told = false;
    std::vector<double> stages(static_cast<std::size_t>(problem.horizon_steps) + 1, 0.0);
    for (int m = 0; m < table.target_count(); ++m) {
      const SearchTarget& target = problem.targets[static_cast<std::size_t>(m)];
      const int p = target.model.position_dim;
      EXPECT_EQ(table.position_dim(m), p);
      EXPECT_EQ(table.layout(m), target.model.has_velocity() ? BlockLayout::kMoving
                                 : p == 3                    ? BlockLayout::kSpatial
                                                             : BlockLayout::kPlanar);
      models::Gaussian belief = target.prior;
      for (int t = 0; t <= problem.horizon_steps; ++t) {
        if (t > 0) {
          belief = models::predict(belief, target.model, problem.step_s);
          const auto& all = problem.fixed_information;
          const auto step = static_cast<std::size_t>(t - 1);
          if (!all.empty() && all[static_cast<std::size_t>(m)][step].size() > 0) {
            const models::StateMatrix& M = all[static_cast<std::size_t>(m)][step];
            belief.covariance = models::update_covariance(belief.covariance, M);
            is_told = is_told || M.norm() > 0.0;
          }
        }
        const std::string where = "seed " + std::to_string(seed) + " target " + std::to_string(m) +
                                  " depth " + std::to_string(t);
        EXPECT_NEAR(table.mean_m(m, t).x(), belief.mean(0), 1e-12) << where;
        EXPECT_NEAR(table.mean_m(m, t).y(), belief.mean(1), 1e-12) << where;
        EXPECT_NEAR(table.mean_m(m, t).z(), p == 3 ? belief.mean(2) : 0.0, 1e-12) << where;
        const double slack = 1e-9 * std::max(1.0, belief.covariance.norm());
        EXPECT_TRUE(
            is_near(unpack(table.layout(m), table.open_loop(m, t)), belief.covariance, slack))
            << where;
        const double log_det = models::log_det(belief.covariance);
        const bool is_log = problem.cost == CostKind::kLogDet;
        const double stage = is_log ? log_det : belief.covariance.trace();
        const double measure = table.open_loop_measure(m, t);
        EXPECT_NEAR(is_log ? std::log(measure) : measure, stage, 1e-8) << where;
        EXPECT_NEAR(table.open_loop_per_measure(m, t) * measure, 1.0, 1e-12) << where;
        stages[static_cast<std::size_t>(t)] += stage;
      }
    }
    EXPECT_EQ(table.has_fixed(), is_told) << seed;
    (is_told ? fixed : unfixed) += 1;
    for (int t = 0; t <= problem.horizon_steps; ++t) {
      EXPECT_NEAR(table.open_loop_cost(t), stages[static_cast<std::size_t>(t)], 1e-7) << seed;
    }
  }
  EXPECT_GT(fixed, 15);
  EXPECT_GT(unfixed, 15);
}

TEST(BeliefTable, AllocatesNothingWithinItsCapacity) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the allocation counter is inert under sanitizers";
  }
  SearchProblem problem;
  problem.horizon_steps = 7;
  problem.targets.assign(5, {{models::TargetKind::kDoubleIntegrator, 2, 0.1},
                             {Eigen::Vector4d::Zero(), Eigen::Matrix4d::Identity()}});
  problem.fixed_information.assign(
      5, std::vector<models::StateMatrix>(7, Eigen::Matrix2d::Identity()));
  BeliefTable table(5, 7);
  const test::AllocationCounter allocations;
  table.reset(problem);
  EXPECT_EQ(allocations.count(), 0U);
}

models::SensorModel sensor_of(models::SensorKind kind, double range_max_m) {
  models::SensorModel sensor;
  sensor.kind = kind;
  sensor.range_max_m = range_max_m;
  return sensor;
}

// Information adds up over the sensors that see the target. An obstacle blocks all sensors: here a
// wall from y = −1 to 1 at x = 2.
TEST(InformationAt, SumsSensorsThatSeeTheTarget) {
  models::World world;
  world.bounds = {{-50.0, -50.0}, {50.0, 50.0}};
  world.obstacles = {{{{1.9, -1.0}, {2.1, 1.0}}, 2.0}};
  const models::SensorModel far = sensor_of(models::SensorKind::kRange, 10.0);
  const models::SensorModel near = sensor_of(models::SensorKind::kPosition, 3.0);
  const models::Viewpoint from{{0.0, 0.0, 0.3}, 1.0};
  using Vector = models::PositionVector;
  for (const Vector& target_m :
       {Vector(Eigen::Vector2d(4.0, 0.5)), Vector(Eigen::Vector2d(4.0, 4.0)),
        Vector(Eigen::Vector2d(1.5, 0.5)), Vector(Eigen::Vector2d(-4.0, 0.5)),
        Vector(Eigen::Vector2d(20.0, 20.0)), Vector(Eigen::Vector3d(1.0, -2.0, 0.7)),
        Vector(Eigen::Vector3d(4.0, -0.5, 0.7))}) {
    const bool is_hidden = target_m(0) > 2.0 && std::abs(target_m(1)) < 1.0;
    const models::PositionMatrix of_far = models::information(far, from, target_m);
    const models::PositionMatrix of_near = models::information(near, from, target_m);
    const models::PositionMatrix sum = of_far + of_near;
    const models::PositionMatrix none = 0.0 * sum;
    for (const auto& sensors : {std::vector{far, near}, std::vector{near, far}}) {
      EXPECT_TRUE(
          is_near(information_at(nullptr, sensors, from, target_m), sum, 1e-12 * sum.norm()));
      EXPECT_TRUE(is_near(information_at(&world, sensors, from, target_m), is_hidden ? none : sum,
                          1e-12 * sum.norm()))
          << target_m.transpose();
    }
    EXPECT_TRUE(is_near(information_at(&world, {}, from, target_m), none, 0.0));
  }
}

// Fixed information is the sum over all teammates with sensors. It is evaluated at the end of each
// step, at the expected target position, and for teammates at any distance from the robot.
TEST(FixedInformation, SumsTeammatesMeasurementsPerStep) {
  std::mt19937_64 rng(54);
  int seen = 0;
  int unseen = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    SearchProblem problem = owned.problem;
    problem.start_time = from_utime(1'700'000'000'000'000);
    std::vector<FixedTeammate> teammates;
    for (int i = pick(rng, 0, 4); i > 0; --i) {
      FixedTeammate& teammate = teammates.emplace_back();
      teammate.trajectory = test::random_teammate(rng, problem.start_time, pick(rng, 0, 6), 0.4);
      teammate.trajectory.start.x_m += uniform(rng, -8.0, 8.0);
      teammate.trajectory.height_m = uniform(rng, 0.8, 2.0);
      teammate.sensor = test::random_problem(1'000 * seed + static_cast<std::uint64_t>(i))
                            .problem.sensors.front();
      teammate.jammed = pick(rng, 0, 3) == 0;
    }
    const auto fixed = fixed_information(problem, teammates);
    ASSERT_EQ(fixed.size(), problem.targets.size());
    for (std::size_t m = 0; m < fixed.size(); ++m) {
      const SearchTarget& target = problem.targets[m];
      const int p = target.model.position_dim;
      ASSERT_EQ(static_cast<int>(fixed[m].size()), problem.horizon_steps);
      models::StateVector mean = target.prior.mean;
      for (std::size_t t = 0; t < fixed[m].size(); ++t) {
        mean = target.model.expected(mean, problem.step_s);
        const Time when =
            problem.start_time + from_seconds(static_cast<double>(t + 1) * problem.step_s);
        models::PositionMatrix sum = models::PositionMatrix::Zero(p, p);
        for (const FixedTeammate& teammate : teammates) {
          if (!teammate.jammed) {
            const Pose2 there = models::at(teammate.trajectory, when).world_from_body;
            sum += information_at(sight_world(problem), {&teammate.sensor, 1},
                                  {there, teammate.trajectory.height_m}, mean.head(p));
          }
        }
        EXPECT_TRUE(is_near(fixed[m][t], sum, 1e-12 * (1.0 + sum.norm()))) << seed << ' ' << m;
        (sum.isZero(0.0) ? unseen : seen) += 1;
      }
    }
  }
  EXPECT_GT(seen, 100);
  EXPECT_GT(unseen, 100);
}

// A teammate comes into range only at the end of the last step, from any side, or the target comes
// into the range of a hovering teammate. A second, invisible target changes nothing.
TEST(FixedInformation, CountsTargetsThatJustComeIntoRange) {
  for (int side = 0; side < 4; ++side) {
    const double to_rad = 0.5 * kPi * side;
    const Eigen::Vector2d away(std::cos(to_rad), std::sin(to_rad));
    SearchProblem problem;
    problem.start_time = from_utime(1'700'000'000'000'000);
    problem.horizon_steps = 4;
    problem.step_s = 0.5;
    Eigen::Vector4d still = Eigen::Vector4d::Zero();
    Eigen::Vector4d coming = Eigen::Vector4d::Zero();
    coming.tail<2>() = away;
    FixedTeammate teammate;
    teammate.sensor.kind = models::SensorKind::kPosition;
    teammate.sensor.range_max_m = 1.0;
    for (const bool it_comes : {false, true}) {
      problem.targets = {
          {{models::TargetKind::kDoubleIntegrator, 2, 0.0}, {still, Eigen::Matrix4d::Identity()}},
          {{models::TargetKind::kDoubleIntegrator, 2, 0.0},
           {it_comes ? coming : still, Eigen::Matrix4d::Identity()}}};
      for (const double beyond_m : {-1e-4, 1e-4}) {
        const Eigen::Vector2d from_m = (3.0 + beyond_m) * away;
        teammate.trajectory = {};
        teammate.trajectory.start_time = problem.start_time;
        teammate.trajectory.start = {from_m.x(), from_m.y(), wrap_to_pi(to_rad + kPi)};
        if (!it_comes) {
          teammate.trajectory.segments = {{{1.0, 0.0}, 2.0, 0.0}};
        }
        const auto fixed = fixed_information(problem, {teammate});
        for (std::size_t t = 0; t < 4; ++t) {
          EXPECT_EQ(fixed[1][t].trace() > 0.0, t == 3 && beyond_m < 0.0) << side << ' ' << t;
          EXPECT_EQ(fixed[0][t].trace() > 0.0, !it_comes && t == 3 && beyond_m < 0.0);
        }
      }
    }
  }
}

// The result equals the sum of logarithms even if the product exceeds the range of a double.
TEST(LogProduct, EqualsTheSumOfLogarithms) {
  std::mt19937_64 rng(53);
  for (int i = 0; i < 100; ++i) {
    LogProduct product;
    EXPECT_EQ(product.log(), 0.0);
    double sum = 0.0;
    double size = 0.0;
    const int side = pick(rng, -1, 1);
    for (int k = pick(rng, 1, 300); k > 0; --k) {
      const double decades =
          side == 0 ? uniform(rng, -149.0, 149.0) : side * uniform(rng, 0.0, 149.0);
      product.multiply(std::pow(10.0, decades));
      sum += decades * std::log(10.0);
      size += std::abs(decades);
      ASSERT_NEAR(product.log(), sum, 1e-13 * (1.0 + size) * std::log(10.0)) << i << ' ' << k;
    }
  }
}

TEST(Lanes, CompareToOneBitPerLaneInOrder) {
  for (unsigned mask = 0; mask < 16; ++mask) {
    const double values[] = {1.0, 4.0, 9.0, 16.0};
    double limits[4];
    for (unsigned lane = 0; lane < 4; ++lane) {
      limits[lane] = ((mask >> lane) & 1U) != 0 ? 100.0 : 0.0;
    }
    EXPECT_EQ(bits(load(values) < load(limits)), mask);
    double roots[4];
    store(roots, sqrt(load(values)) + broadcast(0.5));
    for (int lane = 0; lane < 4; ++lane) {
      EXPECT_EQ(roots[lane], lane + 1.5);
    }
  }
}

}  // namespace
}  // namespace vantage::planner
