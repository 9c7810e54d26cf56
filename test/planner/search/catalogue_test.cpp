#include "planner/search/catalogue.hpp"

#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/problem/block_kernels.hpp"
#include "scenario/scenario.hpp"
#include "test/planner/problem/random_problem.hpp"

namespace vantage::planner {
namespace {

std::set<std::string, std::less<>> names() {
  std::set<std::string, std::less<>> out;
  for (const Algorithm& algorithm : all_algorithms()) {
    EXPECT_TRUE(out.emplace(algorithm.name).second) << algorithm.name << " comes twice";
  }
  return out;
}

TEST(Catalogue, HasTheSearchesThatScenariosMayName) {
  const std::set<std::string, std::less<>> words(scenario::kSearchWords.begin(),
                                                 scenario::kSearchWords.end());
  EXPECT_EQ(words, names());
}

TEST(Catalogue, RefusesOthersWithTheList) {
  try {
    static_cast<void>(algorithm_called("dijkstra"));
    FAIL() << "taken";
  } catch (const UsageError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("dijkstra"), std::string::npos) << what;
    for (const std::string& name : names()) {
      EXPECT_NE(what.find(name), std::string::npos) << name;
    }
  }
}

// What each says of its plan is true: the poses are those of its controls, the cost is that of the
// poses, and no bound is above it.
TEST(Catalogue, EachSaysTheTruthOfItsPlan) {
  for (const Algorithm& algorithm : all_algorithms()) {
    int found = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      test::OwnedProblem owned = test::random_problem(seed);
      SearchProblem& problem = owned.problem;
      if (problem.world == nullptr) {
        continue;
      }
      problem.seed = seed;
      const auto search = algorithm.make(capacity_for(algorithm, problem, 64U << 20U, 20'000), {});
      const SearchResult& result = search->plan(problem, Deadline::nodes(5'000));
      if (!result.found) {
        continue;
      }
      ++found;
      ASSERT_EQ(result.poses.size(), static_cast<std::size_t>(problem.horizon_steps));
      Pose2 at = problem.start;
      for (std::size_t t = 0; t < result.controls.size(); ++t) {
        at = models::step_unicycle(
            at, problem.controls[static_cast<std::size_t>(result.controls[t])], problem.step_s);
        EXPECT_LT((at.position_m() - result.poses[t].position_m()).norm(), 1e-9);
        EXPECT_TRUE(problem.world->bounds.contains(at.position_m()));
      }
      EXPECT_NEAR(result.cost, score(problem, result.poses), 1e-6) << algorithm.name;
      EXPECT_LE(result.lower_bound, result.cost + 1e-6) << algorithm.name;
    }
    EXPECT_GT(found, 10) << algorithm.name;
  }
}

// However many targets: a path from the root to the end can keep the covariances of all of them at
// each depth.
TEST(CapacityFor, HasRoomForAWholePathOfAnyProblem) {
  for (const std::size_t targets : {1U, 100U, 5'000U, 50'000U}) {
    for (const int horizon : {1, 2, 30}) {
      SearchProblem problem;
      problem.targets.resize(targets);
      problem.horizon_steps = horizon;
      const SearchCapacity capacity =
          capacity_for(algorithm_called("beam"), problem, 1U << 20U, 100);
      EXPECT_GE(capacity.block_doubles_max,
                kMaxPacked * targets * static_cast<std::size_t>(horizon + 1))
          << targets << " targets, " << horizon << " steps";
      EXPECT_GT(capacity.nodes_max, static_cast<std::size_t>(horizon));
    }
  }
}

TEST(Catalogue, DrawsByTheProblemsSeed) {
  test::OwnedProblem owned = test::random_problem(3);
  const Algorithm& algorithm = algorithm_called("random_walk");
  const auto search = algorithm.make({}, {});
  std::set<std::vector<int>> ways;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    owned.problem.seed = seed;
    const std::vector<int> once = search->plan(owned.problem, Deadline::never()).controls;
    EXPECT_EQ(search->plan(owned.problem, Deadline::never()).controls, once);
    ways.insert(once);
  }
  EXPECT_GT(ways.size(), 2U);
}

}  // namespace
}  // namespace vantage::planner
