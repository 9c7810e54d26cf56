#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "planner/problem/fixed_information.hpp"
#include "planner/search/catalogue.hpp"
#include "test/planner/search/solved_problems.hpp"

// Searches with a sensor that measures the velocity of moving targets, against exhaustive search.

namespace vantage::planner {
namespace {

using test::slack;

OwnedProblem problem_with_range_rate(std::uint64_t seed) {
  OwnedProblem owned = test::random_problem(seed);
  models::SensorModel& sensor = owned.problem.sensors[0];
  sensor.kind = models::SensorKind::kRangeRate;
  sensor.range_min_m = 0.3;
  sensor.own[0] = seed % 2 == 0 ? 0.05 : 0.4;
  return owned;
}

bool any_moves(const SearchProblem& problem) {
  return std::any_of(problem.targets.begin(), problem.targets.end(),
                     [](const SearchTarget& each) { return each.model.has_velocity(); });
}

TEST(VelocitySensor, EverySearchKeepsItsBoundAndAStarIsOptimal) {
  int solved = 0;
  int mattered = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const OwnedProblem owned = problem_with_range_rate(seed);
    const SearchProblem& problem = owned.problem;
    if (!any_moves(problem)) {
      continue;
    }
    const test::OracleAnswer best = test::best_completion(problem, test::start_of(problem));
    if (best.undecided || !best.found) {
      continue;
    }
    ++solved;
    for (const Algorithm& algorithm : all_algorithms()) {
      if (algorithm.name == "lawn_mower" && problem.world == nullptr) {
        continue;  // the lawn mower needs a world
      }
      const auto search = algorithm.make(test::small_capacity(), {});
      const SearchResult result = search->plan(problem, Deadline::nodes(200'000));
      ASSERT_LE(result.lower_bound, best.cost + slack(best.cost)) << algorithm.name << ' ' << seed;
      if (!result.found) {
        continue;
      }
      ASSERT_GE(result.cost, best.cost - slack(best.cost)) << algorithm.name << ' ' << seed;
      EXPECT_NEAR(score(problem, result.poses), result.cost, 10.0 * slack(result.cost))
          << algorithm.name << ' ' << seed;
      if (algorithm.name == "astar") {
        ASSERT_NEAR(result.cost, best.cost, slack(best.cost)) << seed;
      }
    }
    SearchProblem without = problem;
    without.sensors[0].kind = models::SensorKind::kRange;
    const test::OracleAnswer by_range = test::best_completion(without, test::start_of(without));
    EXPECT_LE(best.cost, by_range.cost + slack(best.cost)) << seed;
    mattered += best.cost < by_range.cost - 0.01 ? 1 : 0;
  }
  EXPECT_GT(solved, 100);
  EXPECT_GT(mattered, 50);
}

// Teammates that measure velocities give information about the state of moving targets, also to a
// robot whose own sensor measures positions only.
TEST(VelocitySensor, IncludesVelocityInformationOfTeammates) {
  int solved = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    OwnedProblem owned = test::random_problem(seed);
    SearchProblem& problem = owned.problem;
    if (!any_moves(problem)) {
      continue;
    }
    FixedTeammate teammate;
    teammate.sensor.kind = models::SensorKind::kRangeRate;
    teammate.sensor.range_min_m = 0.3;
    teammate.trajectory.start_time = problem.start_time;
    teammate.trajectory.start = {1.0, -1.0, 0.5};
    teammate.trajectory.height_m = 1.0;
    problem.fixed_information = fixed_information(problem, {teammate});
    for (std::size_t m = 0; m < problem.targets.size(); ++m) {
      const models::TargetModel& model = problem.targets[m].model;
      ASSERT_EQ(problem.fixed_information[m].front().rows(), model.dim());
    }
    const test::OracleAnswer best = test::best_completion(problem, test::start_of(problem));
    if (best.undecided || !best.found) {
      continue;
    }
    ++solved;
    for (const std::string_view name : {"astar", "beam", "arvi"}) {
      const auto search = algorithm_called(name).make(test::small_capacity(), {});
      const SearchResult result = search->plan(problem, Deadline::nodes(200'000));
      ASSERT_LE(result.lower_bound, best.cost + slack(best.cost)) << name << ' ' << seed;
      ASSERT_TRUE(result.found) << name << ' ' << seed;
      ASSERT_GE(result.cost, best.cost - slack(best.cost)) << name << ' ' << seed;
    }
  }
  EXPECT_GT(solved, 80);
}

}  // namespace
}  // namespace vantage::planner
