#include "planner/search/catalogue.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/problem/block_kernels.hpp"
#include "planner/search/astar.hpp"
#include "planner/search/root_bound.hpp"
#include "scenario/scenario.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/solved_problems.hpp"

namespace vantage::planner {
namespace {

std::set<std::string, std::less<>> names() {
  std::set<std::string, std::less<>> out;
  for (const Algorithm& algorithm : all_algorithms()) {
    EXPECT_TRUE(out.emplace(algorithm.name).second) << algorithm.name << " is listed twice";
  }
  return out;
}

TEST(Catalogue, ContainsTheSearchesOfScenarios) {
  const std::set<std::string, std::less<>> words(scenario::kSearchNames.begin(),
                                                 scenario::kSearchNames.end());
  EXPECT_EQ(words, names());
}

TEST(Catalogue, RefusesUnknownNamesAndListsTheKnownOnes) {
  try {
    static_cast<void>(algorithm_called("dijkstra"));
    FAIL() << "the unknown name was accepted";
  } catch (const UsageError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("dijkstra"), std::string::npos) << what;
    for (const std::string& name : names()) {
      EXPECT_NE(what.find(name), std::string::npos) << name;
    }
  }
}

// The reported poses follow from the controls, the cost follows from the poses, and the lower bound
// is at most the cost.
TEST(Catalogue, ResultsMatchTheirPlans) {
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

// For any number of targets, a path from the root to the horizon can store the covariances of all
// targets at each depth.
TEST(CapacityFor, FitsAnyProblem) {
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

TEST(Catalogue, UsesTheProblemsSeed) {
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

// Each search receives its options: ε and δ if it prunes, the weight if it is weighted.
TEST(Catalogue, PassesOptionsToEachSearch) {
  AlgorithmOptions options;
  options.epsilon = 0.6;
  options.delta_m = 0.8;
  options.yaw_weight_m_per_rad = 1.7;
  options.weight = 2.5;
  const SearchCapacity capacity{20'000, 800'000, 8, 8, 4};
  int differ = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const test::OwnedProblem owned = test::smooth_problem(seed);
    const auto plan_by = [&](const char* name) {
      return algorithm_called(name).make(capacity, options)->plan(owned.problem, Deadline::never());
    };
    const SearchResult rvi = plan_by("rvi");
    EXPECT_EQ(rvi.epsilon, 0.6);
    EXPECT_EQ(rvi.delta_m, 0.8);
    const SearchResult arvi = plan_by("arvi");
    ASSERT_GT(arvi.history.size(), 2U);
    EXPECT_EQ(arvi.history[1].epsilon, 0.6);
    EXPECT_EQ(arvi.history[1].delta_m, 0.8);
    const SearchResult aegis = plan_by("aegis");
    EXPECT_EQ(aegis.epsilon, 0.6);
    EXPECT_EQ(aegis.delta_m, 0.8);
    ReducedOptions reduced;
    reduced.search = ReducedSearch::kSinglePass;
    reduced.epsilon = 0.6;
    reduced.delta_m = 0.8;
    const auto expanded = [&] {
      return ReducedValueIteration(capacity)
          .plan(owned.problem, reduced, Deadline::never())
          .nodes_expanded;
    };
    const std::int64_t lightly = expanded();
    reduced.yaw_weight_m_per_rad = 1.7;
    const std::int64_t heavily = expanded();
    EXPECT_EQ(rvi.nodes_expanded, heavily);
    differ += lightly != heavily ? 1 : 0;
    BestFirstOptions weighted;
    weighted.search = BestFirst::kWeightedAStar;
    weighted.weight = 2.5;
    const SearchResult wastar = plan_by("wastar");
    const SearchResult expected =
        BestFirstSearch(capacity).plan(owned.problem, weighted, Deadline::never());
    EXPECT_EQ(wastar.work_nodes, expected.work_nodes);
    EXPECT_EQ(wastar.controls, expected.controls);
  }
  EXPECT_GT(differ, 5) << "the weight had almost no effect";
}

/// Returns a problem of a robot that can only turn. Targets are ahead, to its left and behind; the
/// field of view is 90°. The robot's poses differ only in heading.
SearchProblem turning_problem() {
  SearchProblem problem;
  problem.horizon_steps = 3;
  problem.step_s = 1.0;
  problem.controls = {{0.0, 0.0}, {0.0, 0.8}, {0.0, -0.8}};
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kPosition;
  sensor.fov_rad = kPi / 2.0;
  sensor.position_sigma_m = 0.5;
  problem.sensors = {sensor};
  for (const double bearing_rad : {1.6, 2.4, -2.4}) {
    problem.targets.push_back({{models::TargetKind::kStatic, 2, 0.0},
                               {3.0 * Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad)),
                                Eigen::Matrix2d::Identity()}});
  }
  return problem;
}

// If the yaw weight or its square is 0 in double precision, poses at one position with different
// headings have distance 0.
TEST(Catalogue, ProvesNoFalseOptimumForAnyYawWeight) {
  const auto expect_true_proofs = [](const SearchProblem& problem, const test::OracleAnswer& best,
                                     const std::string& label) {
    for (const Algorithm& algorithm : all_algorithms()) {
      if (algorithm.name == "lawn_mower" && problem.world == nullptr) {
        continue;  // refuses problems without a world
      }
      for (const double weight_m_per_rad : {0.0, 1e-200, 0.3}) {
        AlgorithmOptions options;
        options.yaw_weight_m_per_rad = weight_m_per_rad;
        const auto search = algorithm.make(test::small_capacity(), options);
        const SearchResult& result = search->plan(problem, Deadline::nodes(200'000));
        const std::string what = std::string(algorithm.name) + ", yaw weight " +
                                 std::to_string(weight_m_per_rad) + ", " + label;
        EXPECT_LE(result.lower_bound, best.cost + test::slack(best.cost)) << what;
        if (result.stop_reason == StopReason::kFinished) {
          EXPECT_NEAR(result.cost, best.cost, test::slack(best.cost)) << what;
        }
      }
    }
  };
  const SearchProblem turning = turning_problem();
  expect_true_proofs(turning, test::best_completion(turning, test::start_of(turning)), "turning");
  for (const auto& [seed, owned, best] : test::solved_problems(0, 60)) {
    if (best.found) {
      expect_true_proofs(owned.problem, best, "seed " + std::to_string(seed));
    }
  }
}

TEST(RootBound, IsAtMostTheOptimumOfARobotThatOnlyTurns) {
  const SearchProblem problem = turning_problem();
  const test::OracleAnswer best = test::best_completion(problem, test::start_of(problem));
  RootBound root(8, 8);
  BeliefTable beliefs(8, 8);
  Expander expander(8, 8, 4);
  beliefs.reset(problem);
  expander.reset(problem);
  EXPECT_LE(root.of_any_plan(problem, beliefs), best.cost);
  std::int64_t work_nodes = 0;
  EXPECT_LE(root.of_moving_plan(Deadline::never(), work_nodes).cost, best.cost);
  EXPECT_LE(root.raise(expander, 1'000'000, Deadline::never(), work_nodes).cost, best.cost);
}

TEST(Catalogue, DescribesEachAlgorithm) {
  for (const Algorithm& algorithm : all_algorithms()) {
    const bool is_beam = algorithm.name == "beam";
    EXPECT_EQ(algorithm.kept_share, is_beam ? 0.25 : 1.0) << algorithm.name;
    EXPECT_EQ(algorithm.is_stateful, algorithm.name == "lawn_mower") << algorithm.name;
    EXPECT_EQ(algorithm.makes_candidates, algorithm.name == "arvi" || algorithm.name == "rvi")
        << algorithm.name;
    const auto search = algorithm.make({1'000, 10'000, 8, 8, 4}, {});
    EXPECT_EQ(search->peak_bytes(), 0U);
    std::uint64_t seed = 0;
    while (test::random_problem(seed).problem.world == nullptr) {
      ++seed;
    }
    const test::OwnedProblem owned = test::random_problem(seed);
    const std::size_t peak = search->plan(owned.problem, Deadline::nodes(300)).peak_bytes;
    EXPECT_EQ(search->peak_bytes(), peak) << algorithm.name;
  }
  const AlgorithmOptions silent;
  EXPECT_EQ(silent.epsilon, 1.0);
  EXPECT_EQ(silent.delta_m, 1.0);
  EXPECT_EQ(silent.yaw_weight_m_per_rad, 0.3);
  EXPECT_EQ(silent.weight, 1.0);
  EXPECT_EQ(silent.sweep.index, 0);
  EXPECT_EQ(silent.sweep.count, 1);
}

// Range measurements of static targets are mapping; any other sensor or a moving target is not.
TEST(DefaultAlgorithm, IsAStarForRangesOfStaticTargets) {
  SearchProblem problem;
  models::SensorModel range;
  range.kind = models::SensorKind::kRange;
  models::SensorModel other;
  const SearchTarget still{{models::TargetKind::kStatic, 2, 0.0}, {}};
  const SearchTarget moves{{models::TargetKind::kDoubleIntegrator, 2, 0.0}, {}};
  problem.sensors = {range, range};
  problem.targets = {still, still};
  EXPECT_EQ(default_algorithm(problem), "astar");
  problem.targets = {still, moves};
  EXPECT_EQ(default_algorithm(problem), "beam");
  problem.targets = {moves, still};
  EXPECT_EQ(default_algorithm(problem), "beam");
  problem.targets = {still};
  for (const models::SensorKind kind :
       {models::SensorKind::kBearing, models::SensorKind::kRangeBearing,
        models::SensorKind::kPosition, models::SensorKind::kCamera}) {
    other.kind = kind;
    problem.sensors = {range, other};
    EXPECT_EQ(default_algorithm(problem), "beam") << kind.name();
    problem.sensors = {other, range};
    EXPECT_EQ(default_algorithm(problem), "beam") << kind.name();
  }
}

// The capacity is the number of stored nodes. It is at least 20,000 and otherwise at most what fits
// into memory, at 260 + 12 · 9 bytes per node (twelve values of 8 bytes with one flag each).
TEST(CapacityFor, FitsKeptNodesIntoMemory) {
  SearchProblem problem;
  problem.targets.resize(3);
  problem.horizon_steps = 7;
  problem.teammates.resize(2);
  const auto nodes = [&](const char* name, std::size_t memory_bytes, std::size_t nodes_max) {
    const SearchCapacity capacity =
        capacity_for(algorithm_called(name), problem, memory_bytes, nodes_max);
    EXPECT_EQ(capacity.targets_max, 3);
    EXPECT_EQ(capacity.horizon_max, 7);
    EXPECT_EQ(capacity.teammates_max, 2);
    EXPECT_EQ(capacity.block_doubles_max, 12 * capacity.nodes_max);
    return capacity.nodes_max;
  };
  constexpr std::size_t kMuch = std::size_t{1} << 40U;
  constexpr std::size_t kNodeBytes = 260 + 12 * 9;
  EXPECT_EQ(nodes("arvi", kMuch, 100'000), 100'000U);
  EXPECT_EQ(nodes("beam", kMuch, 100'000), 25'000U);
  EXPECT_EQ(nodes("arvi", kMuch, 19'999), 20'000U);
  EXPECT_EQ(nodes("beam", kMuch, 79'000), 20'000U);
  EXPECT_EQ(nodes("arvi", 50'000 * kNodeBytes, 100'000), 50'000U);
  EXPECT_EQ(nodes("arvi", 50'000 * kNodeBytes - 1, 100'000), 49'999U);
  EXPECT_EQ(nodes("arvi", 10, 100'000), 20'000U);
  EXPECT_EQ(nodes_within(0.1), 6'000'000U);
  EXPECT_EQ(nodes_within(1e9), 4'000'000'000U);
}

}  // namespace
}  // namespace vantage::planner
