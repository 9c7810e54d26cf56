#include "planner/search/arvi.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "test/planner/search/solved_problems.hpp"
#include "test/support/allocation_counter.hpp"
#include "test/support/page_faults.hpp"

namespace vantage::planner {
namespace {

using test::slack;
using test::small_capacity;

constexpr std::uint64_t kProblems = 240;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

ReducedOptions options(ReducedSearch search, double epsilon = 1.0, double delta_m = 1.0) {
  ReducedOptions options;
  options.search = search;
  options.epsilon = epsilon;
  options.delta_m = delta_m;
  return options;
}

// Calls check(seed, problem, exhaustive answer) for every problem that exhaustive search can
// decide.
template <class Check>
void for_oracle_problems(const Check& check) {
  int solvable = 0;
  for (const auto& [seed, owned, best] : test::solved_problems(0, kProblems)) {
    solvable += best.found ? 1 : 0;
    check(seed, owned.problem, best);
    if (::testing::Test::HasFatalFailure()) {
      return;
    }
  }
  EXPECT_GE(solvable, 200);
}

void expect_optimal(std::uint64_t seed, const SearchProblem& problem,
                    const test::OracleAnswer& best, const SearchResult& result) {
  EXPECT_EQ(result.stop_reason == StopReason::kMemory, false);
  if (!best.found) {  // the robot has to stop before the horizon
    EXPECT_LT(result.moving_steps, problem.horizon_steps) << "seed " << seed;
    return;
  }
  ASSERT_TRUE(result.found) << "seed " << seed;
  EXPECT_EQ(result.moving_steps, problem.horizon_steps);
  EXPECT_NEAR(result.cost, best.cost, slack(best.cost)) << "seed " << seed;
}

TEST(Exhaustive, FindsTheOptimumOfTheReference) {
  ReducedValueIteration search(small_capacity());
  for_oracle_problems(
      [&](std::uint64_t seed, const SearchProblem& problem, const test::OracleAnswer& best) {
        const SearchResult& result =
            search.plan(problem, options(ReducedSearch::kExhaustive), Deadline::never());
        EXPECT_EQ(result.stop_reason, StopReason::kFinished);
        // Work is counted before each check of the deadline: one per generated node and one per
        // expansion. Without pruning, no pruning candidates are compared.
        EXPECT_EQ(result.work_nodes - result.nodes_generated, result.nodes_expanded);
        // Every node that was expanded is stored.
        EXPECT_GE(result.peak_bytes, static_cast<std::size_t>(result.nodes_expanded) * 48);
        expect_optimal(seed, problem, best, result);
      });
}

TEST(Reduced, IsOptimalAtEpsilonAndDeltaZero) {
  ReducedValueIteration search(small_capacity());
  for_oracle_problems(
      [&](std::uint64_t seed, const SearchProblem& problem, const test::OracleAnswer& best) {
        expect_optimal(
            seed, problem, best,
            search.plan(problem, options(ReducedSearch::kSinglePass, 0.0, 0.0), Deadline::never()));
      });
}

TEST(AnytimeReduced, EndsAtTheOptimum) {
  ReducedValueIteration search(small_capacity());
  for_oracle_problems(
      [&](std::uint64_t seed, const SearchProblem& problem, const test::OracleAnswer& best) {
        const SearchResult& result =
            search.plan(problem, options(ReducedSearch::kAnytime), Deadline::never());
        EXPECT_EQ(result.stop_reason, StopReason::kFinished);
        EXPECT_EQ(result.epsilon, 0.0);
        EXPECT_EQ(result.delta_m, 0.0);
        expect_optimal(seed, problem, best, result);
      });
}

TEST(AnytimeReduced, CostNeverIncreases) {
  ReducedValueIteration search(small_capacity());
  int improved = 0;
  for_oracle_problems(
      [&](std::uint64_t seed, const SearchProblem& problem, const test::OracleAnswer&) {
        const SearchResult& result =
            search.plan(problem, options(ReducedSearch::kAnytime), Deadline::never());
        ASSERT_EQ(result.history.size(), 14u);  // (∞, ∞), twelve halvings, (0, 0)
        ASSERT_EQ(static_cast<std::size_t>(result.passes), result.history.size());
        for (std::size_t i = 1; i < result.history.size(); ++i) {
          EXPECT_LE(result.history[i].cost, result.history[i - 1].cost) << "seed " << seed;
          EXPECT_LT(result.history[i].epsilon, result.history[i - 1].epsilon);
          EXPECT_LT(result.history[i].delta_m, result.history[i - 1].delta_m);
        }
        improved += result.history.back().cost < result.history.front().cost ? 1 : 0;
      });
  EXPECT_GT(improved, 50);
}

TEST(AnytimeReduced, HasAPlanAfterTheFirstPass) {
  ReducedValueIteration search(small_capacity());
  for_oracle_problems([&](std::uint64_t seed, const SearchProblem& problem,
                          const test::OracleAnswer& best) {
    const SearchResult first =
        search.plan(problem, options(ReducedSearch::kGreedy), Deadline::never());
    EXPECT_TRUE(first.found || !best.found) << "seed " << seed;
    EXPECT_EQ(first.history.size(), 1u);
    EXPECT_LE(first.nodes_expanded, problem.horizon_steps);
    const SearchResult& anytime =
        search.plan(problem, options(ReducedSearch::kAnytime), Deadline::nodes(first.work_nodes));
    EXPECT_EQ(anytime.controls, first.controls) << "seed " << seed;
  });
}

TEST(SearchResult, CostEqualsScoreOfPoses) {
  ReducedValueIteration search(small_capacity());
  for_oracle_problems([&](std::uint64_t seed, const SearchProblem& problem,
                          const test::OracleAnswer&) {
    for (const std::int64_t budget_nodes : {0, 10, 40, 200}) {
      const SearchResult& result =
          search.plan(problem, options(ReducedSearch::kAnytime), Deadline::nodes(budget_nodes));
      if (!result.found) {
        continue;
      }
      ASSERT_EQ(result.poses.size(), static_cast<std::size_t>(problem.horizon_steps));
      ASSERT_EQ(result.controls.size(), static_cast<std::size_t>(result.moving_steps));
      const double expected = score(problem, result.poses);
      EXPECT_NEAR(result.cost, expected, 1e-8 * std::max(1.0, std::abs(expected)))
          << "seed " << seed;
      Pose2 pose = problem.start;
      for (std::size_t t = 0; t < result.controls.size(); ++t) {
        pose = models::step_unicycle(
            pose, problem.controls[static_cast<std::size_t>(result.controls[t])], problem.step_s);
        EXPECT_NEAR((pose.position_m() - result.poses[t].position_m()).norm(), 0.0, 1e-9);
      }
    }
  });
}

TEST(LowerBound, IsAtMostTheOptimum) {
  ReducedValueIteration search(small_capacity());
  int finite = 0;
  for_oracle_problems(
      [&](std::uint64_t seed, const SearchProblem& problem, const test::OracleAnswer& best) {
        const double bound =
            search.plan(problem, options(ReducedSearch::kGreedy), Deadline::never()).lower_bound;
        EXPECT_FALSE(std::isnan(bound));
        if (best.found) {
          EXPECT_LE(bound, best.cost + slack(best.cost)) << "seed " << seed;
          finite += std::isfinite(bound) ? 1 : 0;
        }
      });
  EXPECT_GE(finite, 150);
}

// With δ = ∞ all nodes are δ-crossing, so pruning depends on ε only.
TEST(Reduced, PrunesByEpsilonOnlyWhenDeltaIsInfinite) {
  ReducedValueIteration search(small_capacity());
  int opened = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    const std::int64_t all =
        search
            .plan(owned.problem, options(ReducedSearch::kSinglePass, 1e-3, kInfinity),
                  Deadline::never())
            .nodes_expanded;
    const std::int64_t wide =
        search
            .plan(owned.problem, options(ReducedSearch::kSinglePass, 1e-3, 1e6), Deadline::never())
            .nodes_expanded;
    EXPECT_EQ(all, wide) << "seed " << seed;
    opened += all > owned.problem.horizon_steps ? 1 : 0;
  }
  EXPECT_GT(opened, 10);
}

TEST(Reduced, AllocatesNothingAfterItsFirstRun) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the sanitizer has its own allocator";
  }
  ReducedValueIteration search(small_capacity());
  for (std::uint64_t seed = 0; seed < kProblems; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    for (const ReducedSearch kind : {ReducedSearch::kAnytime, ReducedSearch::kSinglePass,
                                     ReducedSearch::kGreedy, ReducedSearch::kExhaustive}) {
      const ReducedOptions how = options(kind);
      search.plan(owned.problem, how, Deadline::nodes(3'000));
      const test::AllocationCounter allocations;
      search.plan(owned.problem, how, Deadline::nodes(3'000));
      EXPECT_EQ(allocations.count(), 0u) << "seed " << seed;
    }
  }
}

TEST(Reduced, AllocatesNothingForANewProblem) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the sanitizer has its own allocator";
  }
  ReducedValueIteration search(small_capacity());
  for (std::uint64_t seed = 0; seed < kProblems; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    const test::AllocationCounter allocations;
    search.plan(owned.problem, options(ReducedSearch::kAnytime), Deadline::nodes(2'000));
    EXPECT_EQ(allocations.count(), 0u) << "seed " << seed;
  }
}

// Memory that is reserved for the worst case is committed on first use. A planner in flight touches
// all of it at the start. (A few pages of code or stack may also be touched for the first time.)
TEST(Reduced, CommitsMemoryOnUseUnlessPrefaulted) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the sanitizer has its own memory";
  }
  constexpr long kFew = 16;
  const OwnedProblem owned = test::random_problem(1);
  const auto faults_of = [&](ReducedValueIteration& search) {
    const test::PageFaultCounter faults;
    search.plan(owned.problem, options(ReducedSearch::kAnytime), Deadline::nodes(20'000));
    return faults.count();
  };
  const test::PageFaultCounter faults;
  ReducedValueIteration lean{SearchCapacity{}};
  EXPECT_LT(faults.count(), 1'000);  // 4 MB; 113 MB are reserved
  EXPECT_GT(faults_of(lean), kFew);
  EXPECT_LE(faults_of(lean), kFew);  // memory is reused
  ReducedValueIteration ready{SearchCapacity{}};
  ready.prefault();
  EXPECT_LE(faults_of(ready), kFew);
}

TEST(Reduced, ReportsFullArenaWithPlan) {
  const OwnedProblem owned = test::smooth_problem(3);
  ReducedValueIteration search({40, 4'000, 8, 8, 4});
  const SearchResult& result =
      search.plan(owned.problem, options(ReducedSearch::kExhaustive), Deadline::never());
  EXPECT_EQ(result.stop_reason, StopReason::kMemory);
  EXPECT_TRUE(result.found);
}

}  // namespace
}  // namespace vantage::planner
