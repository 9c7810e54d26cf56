#include <cmath>

#include <gtest/gtest.h>

#include "planner/search/baseline.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/exhaustive_oracle.hpp"
#include "test/planner/search/solved_problems.hpp"

// Compares the paths of baselines without a search with all feasible paths.

namespace vantage::planner {
namespace {

// With and without walls, the walk is collision-free and follows its controls whenever such a path
// exists.
TEST(RandomWalk, FindsCollisionFreePathIfOneExists) {
  RandomWalk walk(test::small_capacity());
  int walked = 0;
  int blocked = 0;
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    SCOPED_TRACE(seed);
    const OwnedProblem owned = test::random_problem(seed);
    const SearchProblem& problem = owned.problem;
    const test::OracleAnswer best = test::best_completion(problem, test::start_of(problem));
    if (best.undecided) {
      continue;
    }
    const SearchResult& result = walk.plan(problem, {}, Deadline::never());
    EXPECT_EQ(result.found && result.moving_steps == problem.horizon_steps, best.found);
    EXPECT_EQ(result.lower_bound, -std::numeric_limits<double>::infinity());
    if (!result.found) {
      continue;
    }
    ASSERT_EQ(result.poses.size(), index(problem.horizon_steps));
    ASSERT_EQ(std::ssize(result.controls), result.moving_steps);
    Pose2 at = problem.start;
    for (std::size_t t = 0; t < result.controls.size(); ++t) {
      const models::UnicycleControl& control = problem.controls[index(result.controls[t])];
      EXPECT_NE(test::arc_clear(problem, at, control, problem.step_s), std::optional(false)) << t;
      at = models::step_unicycle(at, control, problem.step_s);
      EXPECT_LT((result.poses[t].position_m() - at.position_m()).norm(), 1e-9) << t;
      EXPECT_NEAR(wrap_to_pi(result.poses[t].yaw_rad - at.yaw_rad), 0.0, 1e-9) << t;
    }
    EXPECT_NEAR(result.cost, score(problem, result.poses), test::slack(result.cost));
    if (best.found) {
      EXPECT_GE(result.cost, best.cost - test::slack(best.cost));
      ++walked;
    }
    blocked += result.nodes_generated > problem.horizon_steps ? 1 : 0;
  }
  EXPECT_GT(walked, 60);
  EXPECT_GT(blocked, 5);
}

}  // namespace
}  // namespace vantage::planner
