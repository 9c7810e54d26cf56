#include "planner/search/near_bound.hpp"

#include <gtest/gtest.h>

#include "planner/search/root_bound.hpp"
#include "test/planner/exhaustive_oracle.hpp"
#include "test/planner/random_problem.hpp"

namespace vantage::planner {
namespace {

using test::OwnedProblem;
using test::pick;
using test::uniform;

// Targets that the robot is among from the start: bearings from right beside them are what counts.
OwnedProblem crowded_problem(std::uint64_t seed) {
  std::mt19937_64 rng(0xBF58476D1CE4E5B9U * (seed + 1));
  OwnedProblem owned;
  SearchProblem& problem = owned.problem;
  problem.horizon_steps = pick(rng, 2, 5);
  const double speed_mps = uniform(rng, 0.3, 2.0);
  problem.controls = {{speed_mps, 0.0}, {speed_mps, 2.5}, {speed_mps, -2.5}};
  if (problem.horizon_steps < 5) {
    problem.controls.push_back({0.5 * speed_mps, 1.0});
  }
  if (pick(rng, 0, 3) == 0) {
    problem.controls.push_back({0.0, 1.0});
  }
  problem.cost = pick(rng, 0, 2) == 0 ? CostKind::kTrace : CostKind::kLogDet;
  models::SensorModel sensor;
  sensor.kind =
      pick(rng, 0, 2) == 0 ? models::SensorKind::kBearing : models::SensorKind::kRangeBearing;
  sensor.range_max_m = uniform(rng, 1.0, 5.0);
  sensor.range_min_m = pick(rng, 0, 1) == 0 ? 1e-3 : 0.05;
  sensor.variance_grows_with_range = pick(rng, 0, 1) == 0;
  if (pick(rng, 0, 1) == 0) {
    sensor.fov_rad = radians(uniform(rng, 60.0, 300.0));
  }
  problem.sensors = {sensor};
  for (int m = pick(rng, 1, 4); m > 0; --m) {
    SearchTarget target{{models::TargetKind::kDoubleIntegrator, 2, uniform(rng, 0.0, 0.01)}, {}};
    if (pick(rng, 0, 3) == 0) {
      target.model = {models::TargetKind::kRandomWalk, 2, uniform(rng, 1e-4, 0.05)};
    }
    const int n = target.model.dim();
    target.prior.mean = models::StateVector::Zero(n);
    for (int i = 0; i < n; ++i) {
      target.prior.mean(i) = i < 2 ? uniform(rng, -1.5, 1.5) : uniform(rng, -0.4, 0.4);
    }
    // One in two is right on the way of some control.
    if (pick(rng, 0, 1) == 0) {
      const auto& control = problem.controls[rng() % problem.controls.size()];
      const int t = pick(rng, 1, problem.horizon_steps);
      const Eigen::Vector2d p_m =
          models::step_unicycle({}, control, t * problem.step_s).position_m();
      for (int i = 0; i < 2; ++i) {
        const double drift_m = n == 4 ? t * problem.step_s * target.prior.mean(i + 2) : 0.0;
        target.prior.mean(i) = p_m(i) - drift_m + uniform(rng, -0.02, 0.02);
      }
    }
    target.prior.covariance = test::random_spd(rng, n, uniform(rng, 0.1, 2.0), 1.0);
    problem.targets.push_back(target);
  }
  return owned;
}

TEST(NearBound, IsBelowEveryMovingPlanAndOftenTighter) {
  RootBound root(8, 8);
  BeliefTable beliefs(8, 8);
  int tighter = 0;
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    const OwnedProblem owned = crowded_problem(seed);
    const SearchProblem& problem = owned.problem;
    const test::OracleAnswer best = test::best_completion(problem, test::start_of(problem));
    ASSERT_TRUE(best.found);
    beliefs.reset(problem);
    const double any_plan = root.of_any_plan(problem, beliefs);
    std::int64_t work_nodes = 0;
    const auto moving = root.of_moving_plan(Deadline::never(), work_nodes);
    EXPECT_FALSE(moving.expired);
    EXPECT_GE(moving.cost, any_plan);
    // The oracle's recursion loses digits right beside a target.
    ASSERT_LE(moving.cost, best.cost + 1e-4 * std::max(1.0, std::abs(best.cost)))
        << "seed " << seed;
    tighter += moving.cost > any_plan + 0.1 ? 1 : 0;
    for (std::int64_t budget_nodes = 0; budget_nodes < work_nodes; budget_nodes += 3) {
      std::int64_t cut_work_nodes = 0;
      const auto cut = root.of_moving_plan(Deadline::nodes(budget_nodes), cut_work_nodes);
      ASSERT_LE(cut.cost, moving.cost);
      ASSERT_GE(cut.cost, any_plan);
    }
  }
  EXPECT_GT(tighter, 150);
}

}  // namespace
}  // namespace vantage::planner
