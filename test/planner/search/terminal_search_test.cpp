#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/search/catalogue.hpp"
#include "planner/search/root_bound.hpp"
#include "planner/search/terminal_bound.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/exhaustive_oracle.hpp"
#include "test/planner/search/full_tree.hpp"
#include "test/planner/search/solved_problems.hpp"
#include "test/support/allocation_counter.hpp"

// Searches of problems with a terminal value, compared with the plain score and exhaustive search.

namespace vantage::planner {
namespace {

constexpr std::uint64_t kProblems = 240;

// Returns a problem with a terminal value. Every third target is out of reach.
test::OwnedProblem problem_with_tour(std::uint64_t seed) {
  test::OwnedProblem owned = test::random_problem(seed);
  std::mt19937_64 rng(seed);
  for (SearchTarget& target : owned.problem.targets) {
    target.prior.mean(0) += test::pick(rng, 0, 2) == 0 ? 40.0 : 0.0;
  }
  test::add_random_tour(rng, owned.problem);
  owned.problem.seed = seed;
  return owned;
}

// Calls check(seed, problem, exhaustive answer) for the problems that exhaustive search solves.
template <class Check>
int for_solved(std::uint64_t count, const Check& check) {
  int solved = 0;
  for (std::uint64_t seed = 0; seed < count; ++seed) {
    const test::OwnedProblem owned = problem_with_tour(seed);
    const test::OracleAnswer best =
        test::best_completion(owned.problem, test::start_of(owned.problem));
    if (best.found && !best.undecided) {
      ++solved;
      check(seed, owned.problem, best);
    }
  }
  return solved;
}

TEST(TerminalSearch, CostsOfAllNodesEqualThoseOfTheScorer) {
  for (std::uint64_t seed = 0; seed < kProblems; ++seed) {
    const test::OwnedProblem owned = problem_with_tour(seed);
    test::FullTree full(owned.problem);
    ASSERT_TRUE(full.complete);
    for (NodeId id = 1; id < full.tree.node_count(); ++id) {
      const double expected = score(owned.problem, full.path(id));
      ASSERT_NEAR(full.tree[id].cost, expected, 1e-8 * std::max(1.0, std::abs(expected)))
          << "seed " << seed << " node " << id;
      ASSERT_NEAR(full.expander.terminal_value(full.tree, id),
                  terminal_cost(owned.problem, full.path(id)), 1e-9)
          << "seed " << seed << " node " << id;
    }
  }
}

TEST(TerminalSearch, HoverCostsEqualThoseOfTheScorer) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const test::OwnedProblem owned = problem_with_tour(seed);
    test::FullTree full(owned.problem);
    SCOPED_TRACE(seed);
    full.expect_hover_costs(owned.problem);
  }
}

// Every search of the catalogue returns a plan whose cost is its score. No bound exceeds the
// optimum, and a search that claims to be finished has found the optimum.
TEST(TerminalSearch, ProvesNoFalseOptimum) {
  int finished = 0;
  const int solved = for_solved(kProblems, [&](std::uint64_t seed, const SearchProblem& problem,
                                               const test::OracleAnswer& best) {
    for (const Algorithm& algorithm : all_algorithms()) {
      if (algorithm.name == "lawn_mower" && problem.world == nullptr) {
        continue;  // refuses problems without a world
      }
      for (const double epsilon : {0.0, 0.5}) {
        AlgorithmOptions options;
        options.epsilon = epsilon;
        options.delta_m = epsilon;
        options.weight = 1.0 + epsilon;
        const auto search = algorithm.make(test::small_capacity(), options);
        const SearchResult& result = search->plan(problem, Deadline::nodes(200'000));
        const std::string what = std::string(algorithm.name) + ", seed " + std::to_string(seed);
        EXPECT_TRUE(result.has_terminal_value) << what;
        EXPECT_LE(result.lower_bound, best.cost + test::slack(best.cost)) << what;
        if (result.found && result.moving_steps == problem.horizon_steps) {
          EXPECT_NEAR(result.cost, score(problem, result.poses), 10.0 * test::slack(best.cost))
              << what;
          EXPECT_GE(result.cost, best.cost - test::slack(best.cost)) << what;
        }
        if (result.stop_reason == StopReason::kFinished) {
          ++finished;
          EXPECT_NEAR(result.cost, best.cost, 10.0 * test::slack(best.cost)) << what;
        }
      }
    }
  });
  EXPECT_GT(solved, 150);
  EXPECT_GT(finished, 8 * solved);
}

TEST(TerminalSearch, RootBoundsAreBelowTheOptimum) {
  int raised = 0;
  int tight = 0;
  RootBound root(8, 8);
  BeliefTable beliefs(8, 8);
  Expander expander(8, 8, 4);
  for_solved(kProblems,
             [&](std::uint64_t seed, const SearchProblem& problem, const test::OracleAnswer& best) {
               beliefs.reset(problem);
               expander.reset(problem);
               std::int64_t work_nodes = 0;
               const double any = root.of_any_plan(problem, beliefs);
               const double moving = root.of_moving_plan(Deadline::never(), work_nodes).cost;
               const double later =
                   root.raise(expander, work_nodes + 100'000, Deadline::never(), work_nodes).cost;
               EXPECT_LE(any, moving + test::slack(any)) << seed;
               EXPECT_LE(moving, best.cost + test::slack(best.cost)) << seed;
               EXPECT_LE(later, best.cost + test::slack(best.cost)) << seed;
               raised += std::isfinite(later) ? 1 : 0;
               InformationHeuristic heuristic(8, 8);
               heuristic.reset(problem, beliefs);
               TerminalBound terminal(8);
               terminal.reset(problem, beliefs, heuristic);
               tight += terminal.of_any_plan() > 0.0 ? 1 : 0;
             });
  EXPECT_GT(raised, 20);
  EXPECT_GT(tight, 20) << "the bound of the terminal value is trivial";
}

// The bound of a node is at most the terminal value of every plan through it, and does not decrease
// from a node to its children.
TEST(TerminalSearch, NodeBoundsAreConsistent) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const test::OwnedProblem owned = problem_with_tour(seed);
    test::FullTree full(owned.problem);
    InformationHeuristic heuristic(64, 16);
    heuristic.reset(owned.problem, full.expander.beliefs());
    TerminalBound bound(64);
    bound.reset(owned.problem, full.expander.beliefs(), heuristic);
    for (NodeId id = 1; id < full.tree.node_count(); ++id) {
      const Node& node = full.tree[id];
      const Node& parent = full.tree[node.parent];
      const double least = bound.least(node.world_from_body, node.depth);
      ASSERT_GE(least, bound.least(parent.world_from_body, parent.depth) - 1e-9) << seed;
      if (node.depth == owned.problem.horizon_steps) {
        ASSERT_LE(least, full.expander.terminal_value(full.tree, id) + 1e-9) << seed;
      }
    }
  }
}

TEST(TerminalSearch, AllocatesNothingInPlan) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the sanitizer has its own allocator";
  }
  for (const char* const name :
       {"beam", "arvi", "rvi", "fvi", "astar", "wastar", "aegis", "sampling_tree"}) {
    const auto search = algorithm_called(name).make(test::small_capacity(), {});
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      const test::OwnedProblem owned = problem_with_tour(seed);
      const test::AllocationCounter allocations;
      search->plan(owned.problem, Deadline::nodes(3'000));
      EXPECT_EQ(allocations.count(), 0u) << name << ", seed " << seed;
    }
  }
}

TEST(TerminalSearch, RefusesStopsWithoutTarget) {
  test::OwnedProblem owned = problem_with_tour(1);
  owned.problem.targets.clear();
  owned.problem.fixed_information.clear();
  EXPECT_THROW(require_valid(owned.problem), UsageError);
}

// A robot that can measure nothing within its horizon drives towards the first stop.
TEST(TerminalSearch, DrivesTowardsTheFirstStopOfTheTour) {
  SearchProblem problem;
  problem.horizon_steps = 6;
  problem.controls = models::standard_primitives();
  models::SensorModel sensor;
  sensor.range_max_m = 5.0;
  problem.sensors = {sensor};
  problem.targets.push_back({{models::TargetKind::kStatic, 2, 0.0},
                             {Eigen::Vector2d(-80.0, 30.0), Eigen::Matrix2d::Identity()}});
  TerminalValue::Fields fields;
  fields.side = 21;
  fields.cell_m = 1.0;
  fields.min_m = {-10.0, -10.0};
  for (int row = 0; row < fields.side; ++row) {
    for (int column = 0; column < fields.side; ++column) {
      fields.times_s.push_back(std::hypot(column - 10 + 80.0, row - 10 - 30.0) / 3.0);
    }
  }
  problem.terminal = {{{0, 4.0, 0.0}}, fields};
  for (const char* const name : {"beam", "arvi", "greedy", "astar", "aegis", "sampling_tree"}) {
    const auto search = algorithm_called(name).make({200'000, 2'000'000, 4, 8, 1}, {});
    const SearchResult& result = search->plan(problem, Deadline::nodes(50'000));
    ASSERT_TRUE(result.found) << name;
    const Eigen::Vector2d end_m = result.poses.back().position_m();
    const double nearer_m = std::hypot(80.0, 30.0) - (end_m - Eigen::Vector2d(-80.0, 30.0)).norm();
    EXPECT_GT(nearer_m, 4.0) << name;  // m, of at most 9 m; the robot first turns around
  }
}

}  // namespace
}  // namespace vantage::planner
