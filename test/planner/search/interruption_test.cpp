#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "planner/search/arvi.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/same_result.hpp"

namespace vantage::planner {
namespace {

using test::uniform;

SearchCapacity small_capacity() { return {60'000, 3'000'000, 16, 16, 4}; }

// Returns a realistic tracking problem that is too large for any budget of these tests.
SearchProblem tracking_problem(std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  SearchProblem problem;
  problem.horizon_steps = 8;
  problem.controls = models::standard_primitives();
  models::SensorModel sensor;
  sensor.fov_rad = radians(94.0);
  sensor.range_min_m = 0.1;
  problem.sensors = {sensor};
  for (int m = 0; m < 8; ++m) {
    SearchTarget target{{models::TargetKind::kDoubleIntegrator, 2, 0.001}, {}};
    target.prior.mean = Eigen::Vector4d(uniform(rng, -12.0, 12.0), uniform(rng, -12.0, 12.0),
                                        uniform(rng, -0.5, 0.5), uniform(rng, -0.5, 0.5));
    target.prior.covariance = Eigen::Vector4d(1.0, 1.0, 0.1, 0.1).asDiagonal();
    problem.targets.push_back(target);
  }
  return problem;
}

ReducedOptions anytime() { return {}; }

TEST(Interruption, HasAPlanThatImprovesWithTheBudget) {
  ReducedValueIteration search(small_capacity());
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const SearchProblem problem = tracking_problem(seed);
    double last_cost = std::numeric_limits<double>::infinity();
    std::int64_t budget_nodes = 0;
    while (budget_nodes < 30'000) {
      const SearchResult& result = search.plan(problem, anytime(), Deadline::nodes(budget_nodes));
      ASSERT_TRUE(result.found) << budget_nodes;
      EXPECT_EQ(result.stop_reason, StopReason::kDeadline);
      // One expansion may be in progress when the budget ends: its check and its children.
      EXPECT_LE(result.work_nodes,
                budget_nodes + 1 + static_cast<std::int64_t>(problem.controls.size()));
      if (result.moving_steps == problem.horizon_steps) {
        EXPECT_LE(result.cost, last_cost) << budget_nodes;
        last_cost = result.cost;
      } else {
        EXPECT_TRUE(std::isinf(last_cost)) << "a complete plan was lost";
      }
      budget_nodes += budget_nodes < 400 ? 1 : budget_nodes / 8;
    }
    EXPECT_TRUE(std::isfinite(last_cost));
  }
}

TEST(Interruption, IsReproducedByANodeBudgetIfTheClockCausedIt) {
  ReducedValueIteration search(small_capacity());
  int stopped = 0;
  for (const std::uint64_t seed : {4U, 5U, 6U, 7U}) {
    const SearchProblem problem = tracking_problem(seed);
    for (std::int64_t budget_ns = 5'000; budget_ns < 30'000'000; budget_ns = budget_ns * 3 / 2) {
      const SearchResult by_clock =
          search.plan(problem, anytime(), Deadline::at(monotonic_ns() + budget_ns));
      const SearchResult& replayed =
          search.plan(problem, anytime(), Deadline::nodes(by_clock.replay_budget_nodes()));
      test::expect_same(by_clock, replayed);
      EXPECT_EQ(by_clock.stop_reason, replayed.stop_reason);
      stopped += by_clock.stop_reason == StopReason::kDeadline ? 1 : 0;
    }
  }
  EXPECT_GT(stopped, 20);
}

TEST(Interruption, ReproducesAFinishedSearch) {
  ReducedValueIteration search(small_capacity());
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const test::OwnedProblem owned = test::random_problem(seed);
    const SearchResult unlimited = search.plan(owned.problem, anytime(), Deadline::never());
    const SearchResult& replayed =
        search.plan(owned.problem, anytime(), Deadline::nodes(unlimited.replay_budget_nodes()));
    test::expect_same(unlimited, replayed);
    EXPECT_EQ(unlimited.stop_reason, replayed.stop_reason) << "seed " << seed;
  }
}

TEST(Interruption, IsBitIdenticalOverAThousandRepetitions) {
  ReducedValueIteration search(small_capacity());
  ReducedValueIteration used(small_capacity());
  const SearchProblem problem = tracking_problem(8);
  const SearchProblem other = tracking_problem(9);
  const SearchResult first = search.plan(problem, anytime(), Deadline::nodes(1'000));
  for (int i = 0; i < 1'000; ++i) {
    if (i % 10 == 0) {  // earlier plans must have no effect
      used.plan(other, anytime(), Deadline::nodes(100 + i));
    }
    test::expect_same(first, used.plan(problem, anytime(), Deadline::nodes(1'000)));
    ASSERT_FALSE(HasFailure()) << "repetition " << i;
  }
}

// A search that is stopped at any check while it sorts and prunes a level makes no further check.
// With the reported work as budget it stops at the same check again.
TEST(Interruption, IsReproducedFromAnyDeadlineCheck) {
  SearchProblem problem = tracking_problem(1);
  problem.horizon_steps = 4;
  problem.controls.resize(6);
  ReducedOptions options;
  options.search = ReducedSearch::kSinglePass;
  options.epsilon = 0.0;
  options.delta_m = 0.0;  // few nodes are pruned
  ReducedValueIteration search(small_capacity());
  constexpr std::int64_t kSortedAtOnce = 160;
  std::int64_t generated = 0;  // work up to the third level: one per node and one per expansion
  for (std::int64_t budget_nodes = 250; budget_nodes < 420; ++budget_nodes) {
    const SearchResult first = search.plan(problem, options, Deadline::nodes(budget_nodes));
    ASSERT_EQ(first.stop_reason, StopReason::kDeadline);
    test::expect_same(first,
                      search.plan(problem, options, Deadline::nodes(first.replay_budget_nodes())));
    generated = std::max(generated, first.nodes_generated);
  }
  EXPECT_GT(generated, 6 + 6 * 6 + kSortedAtOnce);
}

}  // namespace
}  // namespace vantage::planner
