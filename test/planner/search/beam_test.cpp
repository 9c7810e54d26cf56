#include "planner/search/beam.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "test/planner/search/same_result.hpp"
#include "test/planner/search/solved_problems.hpp"
#include "test/support/allocation_counter.hpp"
#include "test/support/page_faults.hpp"

namespace vantage::planner {
namespace {

using test::slack;
using test::small_capacity;

// Returns options with a small first width, so that many passes drop nodes.
BeamOptions narrow() {
  BeamOptions options;
  options.first_width = 2;
  options.growth = 1.5;
  return options;
}

const std::vector<test::SolvedProblem>& solved() { return test::solved_problems(5000, 400); }

TEST(RefiningBeam, ReportsOptimum) {
  RefiningBeam search(small_capacity());
  int solvable = 0;
  for (const test::SolvedProblem& each : solved()) {
    const SearchProblem& problem = each.owned.problem;
    const SearchResult& result = search.plan(problem, narrow(), Deadline::never());
    EXPECT_EQ(result.stop_reason, StopReason::kFinished);
    if (!each.best.found) {
      EXPECT_LT(result.moving_steps, problem.horizon_steps);
      continue;
    }
    ++solvable;
    ASSERT_TRUE(result.found);
    EXPECT_NEAR(result.cost, each.best.cost, slack(each.best.cost));
    EXPECT_EQ(result.lower_bound, result.cost);
    EXPECT_NEAR(score(problem, result.poses), result.cost, 10.0 * slack(result.cost));
    EXPECT_GE(result.peak_bytes, index(problem.horizon_steps) * sizeof(Node))
        << "includes its own path";
  }
  EXPECT_GE(solvable, 300);
}

// Every budget that allows a complete pass gives a plan. A larger budget never gives a higher cost,
// and the lower bound is at most the cost of every plan.
TEST(RefiningBeam, BoundIsValidAndCostNeverRises) {
  RefiningBeam search(small_capacity());
  int worse = 0;
  for (const test::SolvedProblem& each : solved()) {
    if (!each.best.found) {
      continue;
    }
    const SearchProblem& problem = each.owned.problem;
    double last_cost = std::numeric_limits<double>::infinity();
    for (std::int64_t budget_nodes = 0; budget_nodes < 2'000;
         budget_nodes += 1 + budget_nodes / 2) {
      const SearchResult& result = search.plan(problem, narrow(), Deadline::nodes(budget_nodes));
      EXPECT_LE(result.lower_bound, result.cost);
      if (!result.found || result.moving_steps < problem.horizon_steps) {
        EXPECT_TRUE(std::isinf(last_cost)) << "a complete plan was lost";
        continue;
      }
      EXPECT_LE(result.lower_bound, each.best.cost + slack(each.best.cost));
      EXPECT_GE(result.cost, each.best.cost - slack(each.best.cost));
      EXPECT_LE(result.cost, last_cost);
      last_cost = result.cost;
      worse += result.cost > each.best.cost + slack(each.best.cost) ? 1 : 0;
    }
    EXPECT_TRUE(std::isfinite(last_cost));
  }
  EXPECT_GT(worse, 300);
}

TEST(RefiningBeam, IsBitIdenticalOverAThousandRepetitions) {
  RefiningBeam search(small_capacity());
  RefiningBeam used(small_capacity());
  const OwnedProblem owned = test::smooth_problem(8);
  const Deadline budget = Deadline::nodes(1'000);
  const SearchResult first = search.plan(owned.problem, narrow(), budget);
  for (std::uint64_t i = 0; i < 1'000; ++i) {
    if (i % 10 == 0) {  // earlier plans must have no effect
      used.plan(test::random_problem(i).problem, narrow(), Deadline::nodes(100));
    }
    test::expect_same(first, used.plan(owned.problem, narrow(), budget));
    ASSERT_FALSE(HasFailure()) << "repetition " << i;
  }
}

TEST(RefiningBeam, SearchStoppedByClockIsReproducedByNodeBudget) {
  RefiningBeam search(small_capacity());
  int stopped = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    for (std::int64_t budget_ns = 3'000; budget_ns < 3'000'000; budget_ns *= 2) {
      const SearchResult by_clock =
          search.plan(owned.problem, narrow(), Deadline::at(monotonic_ns() + budget_ns));
      test::expect_same(by_clock, search.plan(owned.problem, narrow(),
                                              Deadline::nodes(by_clock.replay_budget_nodes())));
      stopped += by_clock.stop_reason == StopReason::kDeadline ? 1 : 0;
    }
  }
  EXPECT_GT(stopped, 40);
}

TEST(RefiningBeam, AllocatesNothingForANewProblem) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the sanitizer has its own allocator";
  }
  RefiningBeam search(small_capacity());
  for (std::uint64_t seed = 0; seed < 240; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    const test::AllocationCounter allocations;
    search.plan(owned.problem, narrow(), Deadline::nodes(3'000));
    EXPECT_EQ(allocations.count(), 0u) << "seed " << seed;
  }
}

TEST(RefiningBeam, CausesNoPageFaultAfterPrefault) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the sanitizer has its own memory";
  }
  constexpr long kFew = 16;  // code or stack pages
  const OwnedProblem owned = test::random_problem(1);
  RefiningBeam(small_capacity()).plan(owned.problem, narrow(), Deadline::nodes(20'000));
  RefiningBeam search{SearchCapacity{}};
  search.prefault();
  const test::PageFaultCounter faults;
  search.plan(owned.problem, narrow(), Deadline::nodes(20'000));
  EXPECT_LE(faults.count(), kFew);
}

TEST(RefiningBeam, ReportsAFullArenaAndHasAPlan) {
  const OwnedProblem owned = test::smooth_problem(3);
  RefiningBeam search({80, 4'000, 8, 8, 4});
  const SearchResult& result = search.plan(owned.problem, narrow(), Deadline::nodes(200'000));
  EXPECT_NE(result.stop_reason, StopReason::kFinished);
  EXPECT_EQ(result.moving_steps, owned.problem.horizon_steps);
  EXPECT_LT(result.lower_bound, result.cost);
}

}  // namespace
}  // namespace vantage::planner
