#include "planner/search/astar.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "planner/search/arvi.hpp"
#include "planner/search/root_bound.hpp"
#include "test/planner/search/full_tree.hpp"
#include "test/planner/search/same_result.hpp"
#include "test/planner/search/solved_problems.hpp"
#include "test/support/allocation_counter.hpp"

namespace vantage::planner {
namespace {

using test::slack;
using test::small_capacity;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

BestFirstOptions options(BestFirst search, double weight = 1.0, double epsilon = 0.0,
                         double delta_m = 0.0) {
  BestFirstOptions options;
  options.search = search;
  options.weight = weight;
  options.epsilon = epsilon;
  options.delta_m = delta_m;
  options.dive_every = 16;
  return options;
}

const std::vector<test::SolvedProblem>& solved() { return test::solved_problems(1000, 400); }

// Returns Σ_k L_k, the part of the bound that weights do not change.
double floor_of(const SearchProblem& problem) {
  BeliefTable beliefs(8, 8);
  beliefs.reset(problem);
  InformationHeuristic heuristic(8, 8);
  heuristic.reset(problem, beliefs);
  double sum = 0.0;
  for (int k = 1; k <= problem.horizon_steps; ++k) {
    sum += heuristic.stage_floor(k);
  }
  return sum;
}

TEST(AStar, EqualsExhaustiveSearchWithGapZero) {
  BestFirstSearch search(small_capacity());
  int solvable = 0;
  int dimensions[5] = {};
  for (const test::SolvedProblem& each : solved()) {
    const SearchProblem& problem = each.owned.problem;
    const SearchResult& result =
        search.plan(problem, options(BestFirst::kAStar), Deadline::never());
    if (!each.best.found) {
      EXPECT_LT(result.moving_steps, problem.horizon_steps);
      continue;
    }
    ++solvable;
    for (const SearchTarget& target : problem.targets) {
      ++dimensions[target.model.dim()];
    }
    ASSERT_TRUE(result.found);
    EXPECT_EQ(result.stop_reason, StopReason::kFinished);
    EXPECT_NEAR(result.cost, each.best.cost, slack(each.best.cost));
    EXPECT_EQ(result.lower_bound, result.cost);
    EXPECT_NEAR(score(problem, result.poses), result.cost, 10.0 * slack(result.cost));
  }
  EXPECT_GE(solvable, 300);
  EXPECT_GT(std::min({dimensions[2], dimensions[3], dimensions[4]}), 50);
}

TEST(Aegis, EqualsAStarAtEpsilonAndDeltaZero) {
  BestFirstSearch search(small_capacity());
  for (const test::SolvedProblem& each : solved()) {
    const SearchProblem& problem = each.owned.problem;
    const SearchResult a = search.plan(problem, options(BestFirst::kAStar), Deadline::never());
    const SearchResult& b = search.plan(problem, options(BestFirst::kAegis), Deadline::never());
    ASSERT_EQ(a.found, b.found);
    if (!each.best.found) {
      continue;  // hovering is not in the tree: only the root's bound applies
    }
    EXPECT_NEAR(a.cost, b.cost, slack(a.cost));
    EXPECT_EQ(a.lower_bound, a.cost);
    EXPECT_EQ(b.lower_bound, b.cost);
    EXPECT_LE(b.nodes_expanded, a.nodes_expanded);
  }
}

TEST(WeightedAStar, KeepsItsBoundForPositiveCosts) {
  BestFirstSearch search(small_capacity());
  int above = 0;
  for (const test::SolvedProblem& each : solved()) {
    const SearchProblem& problem = each.owned.problem;
    const double L = floor_of(problem);
    if (!each.best.found || !std::isfinite(L)) {
      continue;
    }
    std::int64_t last_expanded = std::numeric_limits<std::int64_t>::max();
    for (const double w : {1.0, 1.2, 2.0, 10.0}) {
      BestFirstOptions how = options(BestFirst::kWeightedAStar, w);
      how.dive_every = 0;
      const SearchResult& result = search.plan(problem, how, Deadline::never());
      ASSERT_TRUE(result.found);
      EXPECT_LE(result.cost - L, w * (each.best.cost - L) + slack(each.best.cost)) << w;
      EXPECT_LE(result.lower_bound, each.best.cost + slack(each.best.cost)) << w;
      EXPECT_GE(result.cost, each.best.cost - slack(each.best.cost)) << w;
      above += result.cost > each.best.cost + slack(each.best.cost) ? 1 : 0;
      last_expanded = std::min(last_expanded, result.nodes_expanded);
    }
  }
  EXPECT_GT(above, 0) << "no weight had an effect";
}

// With ε and δ > 0, the lower bound holds at every budget.
TEST(Aegis, LowerBoundIsValidAtEveryBudget) {
  BestFirstSearch search(small_capacity());
  int worse = 0;
  int open = 0;
  for (const test::SolvedProblem& each : solved()) {
    const SearchProblem& problem = each.owned.problem;
    if (!each.best.found) {
      continue;
    }
    const double limit = each.best.cost + slack(each.best.cost);
    for (const double size : {0.01, 0.3, 3.0, 1e3}) {
      for (const double w : {1.0, 3.0}) {
        for (const std::int64_t budget_nodes : {20, 150, 1'000'000}) {
          const SearchResult& result =
              search.plan(problem, options(BestFirst::kAegis, w, size, 0.5 * size),
                          Deadline::nodes(budget_nodes));
          EXPECT_LE(result.lower_bound, limit);
          EXPECT_LE(result.lower_bound, result.cost);
          if (result.moving_steps == problem.horizon_steps) {
            EXPECT_GE(result.cost, each.best.cost - slack(each.best.cost));
            worse += result.cost > limit ? 1 : 0;
            open += result.lower_bound < result.cost ? 1 : 0;
          }
        }
      }
    }
  }
  EXPECT_GT(worse, 100);
  EXPECT_GT(open, worse);
}

TEST(BestFirst, ImprovesBoundAndPlanWithBudget) {
  BestFirstSearch search(small_capacity());
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    double last_bound = -kInfinity;
    double last_cost = kInfinity;
    for (std::int64_t budget_nodes = 0; budget_nodes < 2'000;
         budget_nodes += 1 + budget_nodes / 3) {
      const SearchResult& result =
          search.plan(owned.problem, options(BestFirst::kAStar), Deadline::nodes(budget_nodes));
      if (result.moving_steps < owned.problem.horizon_steps) {
        EXPECT_TRUE(std::isinf(last_cost)) << "a complete plan was lost";
        continue;
      }
      EXPECT_LE(result.cost, last_cost) << "seed " << seed;
      EXPECT_GE(result.lower_bound, last_bound) << "seed " << seed;
      EXPECT_LE(result.lower_bound, result.cost);
      last_cost = result.cost;
      last_bound = result.lower_bound;
    }
  }
}

TEST(BestFirst, IsBitIdenticalUnderNodeBudgetAfterOtherPlans) {
  BestFirstSearch search(small_capacity());
  BestFirstSearch used(small_capacity());
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    const BestFirstOptions how = options(BestFirst::kAegis, seed % 2 == 0 ? 1.0 : 2.0, 0.1, 0.2);
    const Deadline budget = Deadline::nodes(static_cast<std::int64_t>(40 * (1 + seed % 20)));
    const SearchResult first = search.plan(owned.problem, how, budget);
    for (int repetition = 0; repetition < 10; ++repetition) {
      used.plan(test::random_problem(seed + 1).problem, how, budget);
      test::expect_same(first, used.plan(owned.problem, how, budget));
    }
  }
}

TEST(BestFirst, SearchStoppedByClockIsReproducedByNodeBudget) {
  BestFirstSearch search(small_capacity());
  int stopped = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    for (std::int64_t budget_ns = 3'000; budget_ns < 3'000'000; budget_ns *= 2) {
      for (const BestFirst kind : {BestFirst::kAStar, BestFirst::kAegis}) {
        const SearchResult by_clock = search.plan(owned.problem, options(kind, 1.0, 0.1, 0.1),
                                                  Deadline::at(monotonic_ns() + budget_ns));
        test::expect_same(by_clock, search.plan(owned.problem, options(kind, 1.0, 0.1, 0.1),
                                                Deadline::nodes(by_clock.replay_budget_nodes())));
        stopped += by_clock.stop_reason == StopReason::kDeadline ? 1 : 0;
      }
    }
  }
  EXPECT_GT(stopped, 40);
}

TEST(BestFirst, AllocatesNothingForANewProblem) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the sanitizer has its own allocator";
  }
  BestFirstSearch search(small_capacity());
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    for (const BestFirst kind : {BestFirst::kAStar, BestFirst::kWeightedAStar, BestFirst::kAegis}) {
      const BestFirstOptions how = options(kind, 1.5, 0.1, 0.1);
      const test::AllocationCounter allocations;
      search.plan(owned.problem, how, Deadline::nodes(2'000));
      EXPECT_EQ(allocations.count(), 0u) << "seed " << seed;
    }
  }
}

// Once the search has a plan, it expands only nodes with a bound below the cost of that plan. Dives
// are switched off.
TEST(WeightedAStar, ExpandsOnlyNodesThatMayImprove) {
  BestFirstSearch search(small_capacity());
  InformationHeuristic heuristic(8, 8);
  BestFirstOptions how = options(BestFirst::kAegis, 3.0);
  how.dive_every = 0;
  how.bound = NodeBound::kReach;
  std::int64_t left_alone = 0;
  for (const test::SolvedProblem& each : solved()) {
    const SearchProblem& problem = each.owned.problem;
    if (!each.best.found) {
      continue;
    }
    SearchResult first;
    for (std::int64_t nodes = 1; first.moving_steps < problem.horizon_steps; ++nodes) {
      first = search.plan(problem, how, Deadline::nodes(nodes));
    }
    const test::FullTree full(problem);
    heuristic.reset(problem, full.expander.beliefs());
    std::vector<double> bounds(full.tree.node_count(), -kInfinity);
    std::int64_t might = 0;
    for (NodeId id = 0; id < full.tree.node_count(); ++id) {
      const Node& node = full.tree[id];
      if (node.depth == problem.horizon_steps) {
        continue;
      }
      bounds[id] = node.cost +
                   heuristic.cost_to_go(node.world_from_body, node.depth, full.tree.posterior(id));
      if (node.parent != kNoNode) {
        bounds[id] = std::max(bounds[id], bounds[node.parent]);
      }
      (bounds[id] <= first.cost + slack(first.cost) ? might : left_alone) += 1;
    }
    const std::int64_t expanded = search.plan(problem, how, Deadline::never()).nodes_expanded;
    EXPECT_LE(expanded, might + problem.horizon_steps) << "seed " << each.seed;
  }
  EXPECT_GT(left_alone, 1'000);
}

TEST(BestFirst, DivesLessOftenIfConfigured) {
  BestFirstSearch search(small_capacity());
  BestFirstOptions how = options(BestFirst::kAStar);
  const auto work_when_diving_every = [&](int nodes) {
    how.dive_every = nodes;
    std::int64_t sum = 0;
    for (const test::SolvedProblem& each : solved()) {
      sum += search.plan(each.owned.problem, how, Deadline::never()).nodes_generated;
    }
    return sum;
  };
  EXPECT_LT(work_when_diving_every(1'000'000), work_when_diving_every(1));
}

TEST(BestFirst, HasAPlanWhenItsMemoryIsFull) {
  BestFirstSearch with_room(small_capacity());
  int full = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    for (const std::size_t doubles : {100U, 300U, 1'000U, 3'000U}) {
      SearchCapacity capacity = small_capacity();
      capacity.block_doubles_max = doubles;
      BestFirstSearch search(capacity);
      const SearchResult result =
          search.plan(owned.problem, options(BestFirst::kAStar), Deadline::never());
      if (result.stop_reason != StopReason::kMemory) {
        continue;
      }
      ++full;
      const SearchResult& by_time = with_room.plan(owned.problem, options(BestFirst::kAStar),
                                                   Deadline::nodes(result.work_nodes));
      EXPECT_EQ(result.cost, by_time.cost) << "seed " << seed << ", " << doubles;
      EXPECT_EQ(result.lower_bound, by_time.lower_bound) << "seed " << seed << ", " << doubles;
    }
  }
  EXPECT_GT(full, 50);
}

TEST(BestFirst, ReportsFullArenaWithPlanAndBound) {
  const OwnedProblem owned = test::smooth_problem(3);
  BestFirstSearch large(small_capacity());
  const double optimum =
      large.plan(owned.problem, options(BestFirst::kAStar), Deadline::never()).cost;
  BestFirstSearch search({60, 4'000, 8, 8, 4});
  const SearchResult& result =
      search.plan(owned.problem, options(BestFirst::kAStar), Deadline::never());
  EXPECT_EQ(result.stop_reason, StopReason::kMemory);
  EXPECT_EQ(result.moving_steps, owned.problem.horizon_steps);
  EXPECT_LE(result.lower_bound, optimum);
}

// Returns the bound of Theorem 6 as published: M̄ = λ_max I for every target, with λ_max over all
// reachable poses.
double isotropic_bound(const SearchProblem& problem) {
  double bound = 0.0;
  double step_m = 0.0;
  for (const models::UnicycleControl& control : problem.controls) {
    step_m = std::max(step_m, std::abs(control.speed_mps) * problem.step_s);
  }
  for (std::size_t m = 0; m < problem.targets.size(); ++m) {
    const models::TargetModel& model = problem.targets[m].model;
    models::Gaussian belief = problem.targets[m].prior;
    for (int t = 1; t <= problem.horizon_steps; ++t) {
      belief = models::predict(belief, model, problem.step_s);
      const int n = model.position_dim;
      const models::PositionVector mean_m = belief.mean.head(n);
      models::PositionMatrix M = models::PositionMatrix::Zero(n, n);
      if (!problem.fixed_information.empty()) {
        const auto& fixed = problem.fixed_information[m][static_cast<std::size_t>(t - 1)];
        M += fixed.size() > 0 ? fixed : models::StateMatrix(models::StateMatrix::Zero(n, n));
      }
      for (const models::SensorModel& sensor : problem.sensors) {
        M += models::information_bound(sensor, {problem.start, problem.height_m}, t * step_m,
                                       mean_m) *
             models::PositionMatrix::Identity(n, n);
      }
      if (!M.allFinite()) {
        return -kInfinity;
      }
      belief.covariance = models::update_covariance(belief.covariance, M);
      bound += problem.cost == CostKind::kLogDet ? models::log_det(belief.covariance)
                                                 : belief.covariance.trace();
    }
  }
  return bound;
}

// The bound is at most the cost of any plan, including hovering, and usually tighter than the
// isotropic bound.
TEST(RootBound, IsBelowEveryPlanAndUsuallyTighterThanIsotropic) {
  RootBound root(8, 8);
  BeliefTable beliefs(8, 8);
  ReducedValueIteration greedy(small_capacity());
  ReducedOptions how;
  how.search = ReducedSearch::kGreedy;
  int tighter = 0;
  for (const test::SolvedProblem& each : solved()) {
    const SearchProblem& problem = each.owned.problem;
    beliefs.reset(problem);
    std::int64_t work_nodes = 0;
    const double any_plan = root.of_any_plan(problem, beliefs);
    const double moving_plan = root.of_moving_plan(Deadline::never(), work_nodes).cost;
    EXPECT_LE(any_plan, moving_plan);
    if (each.best.found) {
      EXPECT_LE(moving_plan, each.best.cost + slack(each.best.cost));
    }
    // An immediate stop followed by a hover is also a plan.
    const SearchResult& plan = greedy.plan(problem, how, Deadline::nodes(0));
    if (plan.found) {
      EXPECT_LE(any_plan, plan.cost + slack(plan.cost));
      EXPECT_LE(plan.lower_bound, plan.cost);
    }
    const double isotropic = isotropic_bound(problem);
    tighter += any_plan > isotropic + slack(isotropic) ? 1 : 0;
  }
  EXPECT_GT(tighter, 150);
}

}  // namespace
}  // namespace vantage::planner
