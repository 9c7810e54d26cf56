#include "planner/search/sampling_tree.hpp"

#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "core/infinity.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/same_result.hpp"
#include "test/planner/search/solved_problems.hpp"

namespace vantage::planner {
namespace {

// A complete tree proves the optimum, from any ε and δ of the first sweep.
TEST(SamplingTree, FindsTheOptimumOfSmallProblems) {
  int finished = 0;
  int solved = 0;
  SamplingTree search(test::small_capacity());
  for (const auto& [seed, owned, best] : test::solved_problems(0, 120)) {
    if (!best.found) {
      continue;
    }
    ++solved;
    for (const double first : {0.0, 1.0, 30.0}) {
      SamplingTreeOptions options;
      options.epsilon = first;
      options.delta_m = first;
      const SearchResult& result = search.plan(owned.problem, options, Deadline::nodes(5'000'000));
      ASSERT_TRUE(result.found) << seed;
      EXPECT_GE(result.cost, best.cost - test::slack(best.cost)) << seed;
      EXPECT_LE(result.lower_bound, best.cost + test::slack(best.cost)) << seed;
      if (result.stop_reason == StopReason::kFinished) {
        ++finished;
        EXPECT_NEAR(result.cost, best.cost, test::slack(best.cost)) << seed;
      }
    }
  }
  EXPECT_GT(solved, 60);
  EXPECT_GT(finished, 3 * solved - solved / 10);
}

TEST(SamplingTree, ImprovesWithTheBudgetAndKeepsToIt) {
  SamplingTree search(test::small_capacity());
  int improved = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const test::OwnedProblem owned = test::random_problem(seed);
    double cost = kInfinity;
    bool is_complete = false;
    for (std::int64_t nodes = 50; nodes <= 6'400; nodes *= 2) {
      const SearchResult& result = search.plan(owned.problem, {}, Deadline::nodes(nodes));
      // The last expansion may add one check and the children.
      EXPECT_LE(result.work_nodes,
                nodes + 2 + static_cast<std::int64_t>(owned.problem.controls.size()));
      const bool now = result.found && result.moving_steps == owned.problem.horizon_steps;
      EXPECT_TRUE(now || !is_complete) << "seed " << seed << " lost its plan";
      if (now && is_complete) {
        EXPECT_LE(result.cost, cost) << seed;
        improved += result.cost < cost ? 1 : 0;
      }
      is_complete = now;
      cost = now ? result.cost : cost;
    }
  }
  EXPECT_GT(improved, 5);
}

TEST(SamplingTree, IsReproducedFromItsWork) {
  SamplingTree search(test::small_capacity());
  SamplingTree other(test::small_capacity());
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    test::OwnedProblem owned = test::random_problem(seed);
    owned.problem.seed = seed;
    const SearchResult first =
        search.plan(owned.problem, {}, Deadline::nodes(100 + 37 * static_cast<int>(seed)));
    test::expect_same(first,
                      other.plan(owned.problem, {}, Deadline::nodes(first.replay_budget_nodes())));
  }
}

TEST(SamplingTree, UsesTheProblemsSeed) {
  test::OwnedProblem owned = test::smooth_problem(3);
  owned.problem.horizon_steps = 6;
  SamplingTree search({20'000, 800'000, 8, 8, 4});
  std::set<std::vector<int>> plans;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    owned.problem.seed = seed;
    plans.insert(search.plan(owned.problem, {}, Deadline::nodes(150)).controls);
  }
  EXPECT_GT(plans.size(), 1U);
}

TEST(SamplingTree, RefusesNegativeOptions) {
  const test::OwnedProblem owned = test::random_problem(1);
  SamplingTree search(test::small_capacity());
  SamplingTreeOptions options;
  options.epsilon = -1.0;
  EXPECT_THROW(search.plan(owned.problem, options, Deadline::nodes(10)), UsageError);
  options = {};
  options.delta_m = -1.0;
  EXPECT_THROW(search.plan(owned.problem, options, Deadline::nodes(10)), UsageError);
  options = {};
  options.yaw_weight_m_per_rad = -1.0;
  EXPECT_THROW(search.plan(owned.problem, options, Deadline::nodes(10)), UsageError);
}

}  // namespace
}  // namespace vantage::planner
